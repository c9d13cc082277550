// The command line: parses it, runs the command, reports errors.
#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/borders/gap_closing.h"
#include "core/grid/web_mercator.h"
#include "server/base/build_id.h"
#include "server/base/failure_words.h"
#include "server/base/heap.h"
#include "server/base/nearest_name.h"
#include "server/cli/commands.h"
#include "server/cli/interruption.h"
#include "server/config/config_settings.h"
#include "server/seed/batch_jobs.h"
#include "server/service/server_log.h"
#include "server/styles/parameter_table.h"
#include "server/styles/style_parameters.h"
#include "server/tiles/tile_request.h"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr const char* kDescription =
    "Trapeze serves maps of polygons as PNG tiles, and simplifies while it draws.\n\n"
    "Examples:\n"
    "  trapeze serve countries.fgb lakes.gpkg      tiles at "
    "http://localhost:8080/tiles/countries,lakes/{z}/{x}/{y}.png\n"
    "  trapeze serve --config trapeze.toml         layers, colours and titles from a file\n"
    "  trapeze config check trapeze.toml           all that is wrong with it\n"
    "  trapeze check buildings.shp                 what is in a file, and what is wrong with it\n"
    "  trapeze prepare buildings.gpkg --output DIR     DIR/buildings.trapeze, served at once\n"
    "  trapeze diff old.trapeze parcels.gpkg --zooms 0-16   the tiles that an edit has changed\n"
    "  trapeze export countries.fgb --zoom 4 --output coarse.gpkg   the polygons of a zoom, as a "
    "file\n"
    "  trapeze render countries.fgb --tile 3/4/2 --style fill=teal --output tile.png\n"
    "  trapeze seed countries.fgb --zooms 0-8 --output world.pmtiles   all tiles in one file\n"
    "  trapeze parameters                          what a style can say, as a table\n\n"
    "Exit status: 0 if all is done; 1 if something failed or was found wrong, such as a file that\n"
    "cannot be read or a port in use; 2 if the command line is wrong; 130 or 143 if SIGINT or\n"
    "SIGTERM interrupted a command, which leaves no half-written file (`serve` ends in order, "
    "with\n"
    "0). Results go to standard output; errors and the log go to standard error.";

constexpr const char* kServeFooter =
    "\nExamples:\n"
    "  trapeze serve countries.fgb                 "
    "http://localhost:8080/tiles/countries/0/0/0.png\n"
    "  trapeze serve --port 9000 --address 127.0.0.1 buildings.fgb water.fgb\n"
    "  trapeze serve --config trapeze.toml --workers 4\n\n"
    "What can be asked for: /tiles/{layers}/{z}/{x}/{y}[@2x].png, /tiles/{layers}.json "
    "(TileJSON),\n"
    "/catalog, /health, /ready, /metrics, and the viewer at /. SIGTERM and SIGINT end the server "
    "in\n"
    "order, SIGHUP lets it read its layers again.";

constexpr const char* kConfigFooter =
    "\nExamples:\n"
    "  trapeze config check trapeze.toml           every mistake with its line and column\n"
    "  trapeze config print --config trapeze.toml --port 9000\n"
    "  trapeze config schema                       for editors that complete and check\n\n"
    "The command line overrides the environment (TRAPEZE_TABLE_KEY, TRAPEZE_SERVER_PORT for\n"
    "server.port), which overrides the file; in strings of the file, ${NAME} stands for a "
    "variable.";

constexpr const char* kCheckFooter =
    "\nExamples:\n"
    "  trapeze check countries.fgb buildings.shp\n"
    "  trapeze check --strict delivery.gpkg\n"
    "  trapeze check --list errors.geojson parcels.gpkg\n\n"
    "The exit status is 1 if a file cannot be read, or if more features are skipped than\n"
    "--max-skipped allows; repaired and other skipped features are only listed. --list writes the\n"
    "places where polygons do not fit together, as they are in FILE: kind (gap or overlap), area "
    "in\n"
    "square metres, width in metres, and the ids of the features.";

constexpr const char* kSeedFooter =
    "\nExamples:\n"
    "  trapeze seed countries.fgb --zooms 0-8 --output world.pmtiles\n"
    "  trapeze seed --config trapeze.toml --layers land,water --style style=night --zooms 0-14 \\\n"
    "    --bbox 14.1,35.7,14.6,36.1 --output malta.mbtiles\n"
    "  trapeze seed --config trapeze.toml --zooms 0-14 --dry-run\n"
    "  trapeze seed --config trapeze.toml --zooms 0-14 --part 3/8 --output world.part3\n"
    "  trapeze seed --join world.part* --output world.pmtiles\n"
    "  trapeze seed --config trapeze.toml --zooms 0-14 --output world.pmtiles --parts 8 \\\n"
    "    --jobs slurm >seed.sbatch\n\n"
    "Tiles have the bytes that `trapeze serve` with the same options answers with. Where nothing "
    "but\n"
    "one colour is seen they are not drawn, nor looked at one by one. What has been done is kept "
    "in\n"
    "OUT.seeding until the archive is there: interrupted, the same command goes on. The bytes of "
    "the\n"
    "archive do not depend on that, nor on threads or parts.";

constexpr const char* kPrepareFooter =
    "\nExamples:\n"
    "  trapeze prepare buildings.gpkg water.fgb --output prepared\n"
    "  trapeze serve prepared/buildings.trapeze prepared/water.trapeze\n"
    "  trapeze prepare buildings.gpkg --output prepared --reuse prepared\n"
    "  trapeze prepare country.fgb --part 1-64/64 --output parts\n"
    "  trapeze prepare country.fgb --part $SLURM_ARRAY_TASK_ID/64 --output parts\n"
    "  trapeze prepare --join 'parts/*.trapeze' --output parts\n"
    "  trapeze serve 'parts/*.trapeze'\n\n"
    "A prepared file holds a layer as it is served: it is mapped and not built again, servers on\n"
    "one machine share its memory, and tiles and their ETags are those of FILE. It is refused if "
    "it\n"
    "is damaged, if FILE has changed since, or if this version of Trapeze builds layers "
    "otherwise:\n"
    "prepare it again then. Without FILE it is served all the same. Preparing again replaces it\n"
    "under a running server without harm; write into it by no other means.\n"
    "\n"
    "--part builds a layer part by part, on one machine or on many, in the memory that a part\n"
    "takes: each looks at all of FILE first, and divides it by place in the same way; then it\n"
    "reads its own features, which is fast of a FlatGeobuf with a spatial index. Features that\n"
    "come near each other are in one part. All parts together are served as one layer. --join\n"
    "makes an overview of them, which low zooms need; --part 1-N/N makes it too.";

constexpr const char* kDiffFooter =
    "\nExamples:\n"
    "  trapeze diff yesterday.trapeze parcels.gpkg --zooms 0-16\n"
    "  trapeze diff old.fgb new.fgb --zooms 12 --style 'color-by=use' --format geojson\n\n"
    "OLD and NEW are states of one layer, as sources or prepared. A tile is listed if what it is\n"
    "drawn from has changed: none whose picture has is left out. That of some may be the same all\n"
    "the same, where the change is too small to be seen: --certainty bytes draws both and lists\n"
    "those that differ. --certainty candidates looks at no tile, and lists those that any style "
    "with\n"
    "that simplify may change, but for styles by id: for purging what is kept of all styles.";

constexpr const char* kExportFooter =
    "\nExamples:\n"
    "  trapeze export countries.fgb --zoom 4 --output coarse.gpkg\n"
    "  trapeze export buildings.shp --zoom 14 --simplify 2 --crs EPSG:3857 --output rough.fgb\n"
    "  trapeze export landcover.gpkg --zoom 12 --smooth 8 --output smooth.gpkg\n"
    "  trapeze export rivers.gpkg --zoom 9 --grow 3 --output wide.gpkg\n\n"
    "The polygons are those that tiles of that zoom are drawn from; attributes are kept, and the\n"
    "field trapeze_id holds the id of each feature in FILE. What is too small to be left at that\n"
    "tolerance is left out and counted. With --topology strict all polygons are valid.";

constexpr const char* kRenderFooter =
    "\nExamples:\n"
    "  trapeze render countries.fgb --tile 3/4/2 --output tile.png\n"
    "  trapeze render land.fgb lakes.fgb --tile 0/0/0 --scale 2 \\\n"
    "      --style 'lakes.fill=6fa8c9&background=white' --output world.png";

constexpr const char* kBenchFooter =
    "\nExamples:\n"
    "  trapeze bench experiment                    the paper's experiment\n"
    "  trapeze bench experiment --help             what it can be asked for\n\n"
    "Benchmarks are programs of their own, trapeze-NAME in the folder bench beside this program:\n"
    "they need libraries that this one does not. They are built with the release preset.";

/// The purpose of the setting, the words it accepts if there are only a few, and its default.
std::string help_of(const std::string& name) {
  const auto& settings = trapeze::config_settings();
  const auto setting =
      std::ranges::find_if(settings, [&name](const auto& each) { return each.name() == name; });
  std::string help = setting->help;
  help.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(help.front())));
  if (!setting->choices.empty()) help += ". Takes " + setting->takes;
  const trapeze::SettingValue value = setting->get(trapeze::Config());
  if (const auto* number = std::get_if<std::int64_t>(&value)) {
    return help + ". If not set: " + std::to_string(*number);
  }
  const auto& text = std::get<std::string>(value);
  return text.empty() ? help : help + ". If not set: " + text;
}

trapeze::ConfigOverride parse_assignment(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  std::vector<std::string> known;
  for (const auto& setting : trapeze::config_settings()) known.push_back(setting.name());
  const bool is_known = std::ranges::find(known, name) != known.end();
  if (equals == std::string::npos || !is_known) {
    throw trapeze::UsageError("--set takes TABLE.KEY=VALUE of a setting, given was \"" + text +
                              "\"; `trapeze config print` shows all settings" +
                              (is_known ? "" : trapeze::did_you_mean(name, known)));
  }
  return {name, text.substr(equals + 1), "--set " + name};
}

/// An option for a setting of the configuration, either text or an integer.
void add_setting(CLI::App& command, trapeze::ServeArguments& arguments, const std::string& option,
                 const std::string& setting, const char* type) {
  command
      .add_option_function<std::string>(
          option,
          [&arguments, option, setting](const std::string& value) {
            arguments.settings.push_back({setting, value, option});
          },
          help_of(setting))
      ->type_name(type);
}

/// A numeric option; `set` receives its name and its value as text.
CLI::Option& add_number(CLI::App& command, const std::string& option, const char* type,
                        const std::string& help,
                        const std::function<void(const std::string&, const std::string&)>& set) {
  return *command
              .add_option_function<std::string>(
                  option, [option, set](const std::string& text) { set(option, text); }, help)
              ->type_name(type);
}

/// `limit` is left unchanged if neither option is given; `if_not_set` describes that case.
template <typename Limit>
void add_max_skipped(CLI::App& command, Limit& limit, const char* if_not_set) {
  add_number(command, "--max-skipped", "N",
             fmt::format("How many features of a layer may be skipped because they cannot be "
                         "drawn, as a number or as a share of all such as 1%; more are an error. "
                         "If not set: {}",
                         if_not_set),
             [&limit](const std::string& option, const std::string& text) {
               limit = trapeze::skip_limit_or_throw(option, text);
             });
  // Options take effect in the order in which they are added.
  command.add_flag_callback(
      "--strict", [&limit] { limit = trapeze::skip_limit_or_throw("--strict", "0"); },
      "No feature may be skipped, whatever --max-skipped says");
}

void add_coverage(CLI::App& command, trapeze::CoverageArguments& coverage,
                  const std::string& if_not_set) {
  command
      .add_option(
          "--coverage", coverage.mode,
          fmt::format("Whether polygons that share borders keep them in common: auto, on or "
                      "off; as the setting of layers. If not set: {}",
                      if_not_set))
      ->type_name("NAME");
  add_number(command, "--close-gaps", "METRES",
             "Close gaps and overlaps between polygons of up to so many metres on the ground; not "
             "with --coverage off",
             [&coverage](const std::string& option, const std::string& text) {
               coverage.close_gaps = trapeze::number_or_throw(option, text, 0, trapeze::kWidestGap);
             });
  add_number(command, "--merge", "PIXELS",
             "Make one block of polygons that are nearer to each other than so many pixels, at the "
             "usual simplify of 0.25; not with --coverage off",
             [&coverage](const std::string& option, const std::string& text) {
               coverage.merge = trapeze::number_or_throw(option, text, 0, trapeze::kWidestMerge);
             });
  command
      .add_option("--merge-by", coverage.merge_by,
                  "Only polygons with the same value of this attribute become one block; with "
                  "--merge")
      ->type_name("ATTRIBUTE");
}

std::string usual_coverage() {
  return std::string(trapeze::kCoverageNames.name_of(trapeze::kUsualCoverage));
}

/// For commands that read files which may have been prepared.
std::string coverage_of_files() {
  return "as a file was prepared, else " + usual_coverage();
}

/// For commands that draw: the layers, and the renderer.
void add_drawing_settings(CLI::App& command, trapeze::ServeArguments& arguments) {
  command.add_option(
      "FILE", arguments.files,
      "Files of polygons, in a format that GDAL reads, or prepared ones; each becomes "
      "a layer named after it, as do the parts of a layer together that have such "
      "a name as 'parts/*.trapeze'. Instead of the layers of the configuration.");
  command
      .add_option("--config", arguments.config, "Configuration (TOML); options here override it")
      ->type_name("FILE");
  add_coverage(command, arguments.coverage,
               "as configured; where nothing is, " + coverage_of_files());
  add_max_skipped(command, arguments.max_skipped, "as configured");
  add_setting(command, arguments, "--workers", "server.workers", "N");
  add_setting(command, arguments, "--renderer", "server.renderer", "NAME");
  add_setting(command, arguments, "--device", "server.device", "DEVICE");
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&arguments](const std::vector<std::string>& assignments) {
            for (const std::string& text : assignments) {
              arguments.settings.push_back(parse_assignment(text));
            }
          },
          "Any setting of the configuration: limits.connections=100; may be given several times")
      ->type_name("TABLE.KEY=VALUE")
      ->allow_extra_args(false);
}

void add_settings(CLI::App& command, trapeze::ServeArguments& arguments) {
  add_drawing_settings(command, arguments);
  add_setting(command, arguments, "--port", "server.port", "N");
  add_setting(command, arguments, "--address", "server.address", "IP");
  add_setting(command, arguments, "--threads", "server.threads", "N");
  add_setting(command, arguments, "--web-root", "server.web_root", "DIR");
}

void add_serve(CLI::App& app, trapeze::ServeArguments& arguments) {
  CLI::App* serve = app.add_subcommand("serve", "Serve tiles over HTTP");
  serve->footer(kServeFooter);
  add_settings(*serve, arguments);
}

void add_config(CLI::App& app, std::string& path, trapeze::ServeArguments& arguments) {
  CLI::App* config = app.add_subcommand("config", "Check or show a configuration");
  config->footer(kConfigFooter);
  config->require_subcommand(1);
  config
      ->add_subcommand("check",
                       "Tell all that is wrong with a configuration, and with the files that it "
                       "names")
      ->add_option("FILE", path, "Configuration (TOML)")
      ->required();
  CLI::App* print =
      config->add_subcommand("print",
                             "Print what `serve` would do with the same options, with the "
                             "origin of each value");
  add_settings(*print, arguments);
  config->add_subcommand("schema", "Print the JSON Schema of configurations");
}

void add_check(CLI::App& app, trapeze::CheckArguments& arguments) {
  CLI::App* check = app.add_subcommand("check", "Load files and report what is in them");
  check->footer(kCheckFooter);
  check->add_option("FILE", arguments.files, "Files of polygons, or prepared ones")->required();
  add_coverage(*check, arguments.coverage, coverage_of_files());
  add_max_skipped(*check, arguments.max_skipped, "100%");
  check
      ->add_option("--list", arguments.list,
                   "A file to write with the gaps and overlaps between the polygons of FILE, their "
                   "areas, widths and features: .geojson, .gpkg or .fgb")
      ->type_name("OUT");
  check->add_flag("--overwrite", arguments.overwrite, "Replace OUT if it exists");
}

void add_prepare(CLI::App& app, trapeze::PrepareArguments& arguments) {
  CLI::App* prepare =
      app.add_subcommand("prepare", "Save layers in files that are served without building them");
  prepare->footer(kPrepareFooter);
  prepare->add_option("FILE", arguments.files, "Files of polygons, in a format that GDAL reads");
  prepare
      ->add_option("--weights", arguments.weights,
                   fmt::format("What decides which vertices go: {}; {} if not set",
                               trapeze::listed(trapeze::kWeightNames.names()), arguments.weights))
      ->type_name("NAME");
  add_coverage(*prepare, arguments.coverage, usual_coverage());
  prepare
      ->add_option("--source-layer", arguments.selection.layer,
                   "The layer or table of FILE; all that hold polygons if not set")
      ->type_name("NAME");
  prepare
      ->add_option("--where", arguments.selection.where,
                   "A condition on features in SQL, such as \"height > 20\"")
      ->type_name("SQL");
  prepare
      ->add_option("--attributes", arguments.selection.attributes,
                   "The attributes that are kept, with commas between them; all if not set")
      ->delimiter(',')
      ->type_name("NAME,...");
  add_max_skipped(*prepare, arguments.max_skipped, "100%");
  prepare
      ->add_option("--output", arguments.output,
                   "The folder to write into; each file is named after FILE, and ends in .trapeze. "
                   "An overview can be given a name that ends so")
      ->required()
      ->type_name("DIR");
  prepare
      ->add_option(
          "--part", arguments.part,
          "Prepare the I-th of N parts with about as many vertices each; A-B/N: those from "
          "the A-th to the B-th, one after the other")
      ->type_name("I/N");
  prepare
      ->add_option("--join", arguments.join,
                   "Make an overview of all these parts for low zooms, and do nothing else")
      ->type_name("PART ...");
  prepare
      ->add_option(
          "--crs", arguments.crs,
          "Reference systems to prepare for besides EPSG:3857, such as EPSG:2056: each is a "
          "file of its own, which ends in .EPSG-2056.trapeze")
      ->delimiter(',')
      ->type_name("NAME,...");
  prepare
      ->add_option("--reuse", arguments.reuse,
                   "A file prepared before, or the folder of such files, perhaps that of --output: "
                   "polygons, and groups of polygons with shared borders, that have not changed "
                   "since are taken over from there. What is written is the same without it")
      ->type_name("OLD");
}

void add_diff(CLI::App& app, trapeze::DiffArguments& arguments) {
  CLI::App* diff =
      app.add_subcommand("diff", "List the tiles that differ between two states of a layer");
  diff->footer(kDiffFooter);
  diff->add_option("OLD", arguments.before, "A file of polygons, or a prepared one")->required();
  diff->add_option("NEW", arguments.after, "The same layer later")->required();
  diff->add_option("--zooms", arguments.zooms, "The zooms of the tiles, such as 0-16")
      ->required()
      ->type_name("A-B");
  diff->add_option("--style", arguments.style, "Style, written as in the query of a URL")
      ->type_name("QUERY");
  add_number(*diff, "--scale", "N", "Pixels in 256ths of a tile's side, 1 to 4",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.scale = trapeze::integer_or_throw(option, text, 1, 4);
             });
  add_coverage(*diff, arguments.coverage, coverage_of_files());
  diff->add_option(
          "--certainty", arguments.certainty,
          fmt::format("Which tiles are listed: {}; {} if not set",
                      trapeze::listed(trapeze::kCertaintyNames.names()), arguments.certainty))
      ->type_name("NAME");
  diff->add_option("--format", arguments.format,
                   fmt::format("{}; text, a line z/x/y for each, if not set",
                               trapeze::listed(trapeze::kTileListNames.names())))
      ->type_name("NAME");
}

void add_export(CLI::App& app, trapeze::ExportArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("export", "Write the polygons of a zoom into a file for other programs");
  command->footer(kExportFooter);
  command->add_option("FILE", arguments.file, "A file of polygons")->required();
  add_number(*command, "--zoom", "Z", "The zoom whose tiles show these polygons, 0 to 24",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.zoom = trapeze::integer_or_throw(option, text, 0, trapeze::kMaxZoom);
             })
      .required();
  add_number(
      *command, "--simplify", "PX",
      fmt::format("Tolerance in pixels, {} if not set, as tiles are drawn; 0 removes nothing",
                  arguments.simplify),
      [&arguments](const std::string& option, const std::string& text) {
        arguments.simplify =
            trapeze::number_or_throw(option, text, 0, std::numeric_limits<double>::max());
      });
  const auto add_reshaping = [&](const char* name, trapeze::ParameterId id, const char* help,
                                 double& value) {
    const double most = trapeze::style_parameter(id).max;
    add_number(*command, name, "PX", fmt::format(fmt::runtime(help), most),
               [&value, most](const std::string& option, const std::string& text) {
                 value = trapeze::number_or_throw(option, text, 0, most);
               });
  };
  add_reshaping("--smooth", trapeze::ParameterId::smooth,
                "Corners rounded as tiles in a style with smooth show them: as far as so many "
                "pixels along their edges, 0 to {}; all polygons are held in memory",
                arguments.smooth);
  add_reshaping("--grow", trapeze::ParameterId::grow,
                "What is narrower than so many pixels grows as tiles in a style with grow show it, "
                "0 to {}; not beside --smooth; all polygons are held in memory",
                arguments.grow);
  command
      ->add_option(
          "--topology", arguments.topology,
          fmt::format("{} ({} if not set); fast: without the test that keeps polygons "
                      "from crossing themselves; what crosses is noded",
                      trapeze::listed(trapeze::kTopologyNames.names()), arguments.topology))
      ->type_name("NAME");
  command
      ->add_option("--weights", arguments.weights,
                   fmt::format("What decides which vertices go: {}; {} if not set",
                               trapeze::listed(trapeze::kWeightNames.names()), arguments.weights))
      ->type_name("NAME");
  add_coverage(*command, arguments.coverage, usual_coverage());
  command
      ->add_option("--crs", arguments.crs,
                   "EPSG:4326 (degrees, if not set) or EPSG:3857 (metres, the map as it is drawn)")
      ->type_name("NAME");
  command->add_flag("--overwrite", arguments.overwrite, "Replace OUT if it exists");
  command
      ->add_option("--output", arguments.output,
                   "The file to write: .fgb (FlatGeobuf), .gpkg (GeoPackage) or .geojson (GeoJSON)")
      ->required()
      ->type_name("OUT");
}

void add_render(CLI::App& app, trapeze::RenderArguments& arguments) {
  CLI::App* render = app.add_subcommand("render", "Draw one tile into a file");
  render->footer(kRenderFooter);
  render->add_option("FILE", arguments.files, "Files of polygons, each a layer, the lowest first")
      ->required();
  render->add_option("--tile", arguments.tile, "Zoom, column and row of the tile")
      ->required()
      ->type_name("Z/X/Y");
  add_number(*render, "--scale", "N", "Pixels in 256ths of a tile's side, 1 to 4",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.scale = trapeze::integer_or_throw(option, text, 1, 4);
             });
  render->add_option("--style", arguments.style, "Style, written as in the query of a URL")
      ->type_name("QUERY");
  add_coverage(*render, arguments.coverage, coverage_of_files());
  render->add_option("--renderer", arguments.renderer, help_of("server.renderer"))
      ->type_name("NAME");
  render->add_option("--device", arguments.device, help_of("server.device"))->type_name("DEVICE");
  render->add_option("--output", arguments.output, "The picture to write: .png or .webp")
      ->required()
      ->type_name("F");
}

void add_seed(CLI::App& app, trapeze::SeedArguments& arguments) {
  CLI::App* seed =
      app.add_subcommand("seed", "Draw all tiles of an area into an archive or a folder");
  seed->footer(kSeedFooter);
  add_drawing_settings(*seed, arguments.serve);
  seed->add_option("--layers", arguments.layers,
                   "The layers of the tiles, the lowest first, with commas between them; all if "
                   "not set")
      ->delimiter(',')
      ->type_name("NAME,...");
  seed->add_option("--style", arguments.style,
                   "Style, written as in the query of a URL, such as style=night&fill=teal")
      ->type_name("QUERY");
  seed->add_option("--zooms", arguments.zooms, "The zooms of the tiles, such as 0-14")
      ->type_name("A-B");
  seed->add_option("--bbox", arguments.bbox,
                   "The tiles that meet this box, in degrees; those of the whole world if not set")
      ->type_name("W,S,E,N");
  add_number(*seed, "--scale", "N", "Pixels in 256ths of a tile's side, 1 to 4",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.scale = trapeze::integer_or_throw(option, text, 1, 4);
             });
  seed->add_option(
          "--format", arguments.format,
          fmt::format("{}; {} if not set", trapeze::listed(trapeze::kTileFormatNames.names()),
                      arguments.format))
      ->type_name("NAME");
  seed->add_option("--output", arguments.output,
                   "The archive to write, .pmtiles or .mbtiles; else a folder, "
                   "OUT/{z}/{x}/{y}.png")
      ->type_name("OUT");
  seed->add_flag("--sparse", arguments.is_sparse,
                 "Leave out tiles in which nothing is seen, as is always done in a folder");
  seed->add_flag("--dry-run", arguments.is_dry_run,
                 "Only estimate how many tiles are to be drawn, how large they are, and how long "
                 "that takes");
  seed->add_option("--update", arguments.update,
                   "An archive that was seeded before, in PMTiles, perhaps that of --output: tiles "
                   "that have not changed since are taken from there. What is written is the same "
                   "without it")
      ->type_name("OLD");
  seed->add_option("--part", arguments.part,
                   "Seed one of N parts of about equal cost; OUT is then a file for --join")
      ->type_name("I/N");
  seed->add_option("--join", arguments.join,
                   "Make the archive of all these parts, and do nothing else")
      ->type_name("PART ...");
  seed->add_option("--jobs", arguments.jobs,
                   fmt::format("Print what seeds the archive in --parts on many machines, and do "
                               "nothing else: {}",
                               trapeze::listed(trapeze::kBatchSystemNames.names())))
      ->type_name("SYSTEM");
  add_number(*seed, "--parts", "N", "How many parts --jobs divides the work into",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.parts = trapeze::integer_or_throw(option, text, 1, trapeze::kMostParts);
             });
}

/// Everything after the name of a benchmark is passed to the benchmark, including --help.
std::optional<trapeze::BenchArguments> bench_arguments(int argc, char** argv) {
  if (argc < 3 || std::string_view(argv[1]) != "bench" || argv[2][0] == '-') return std::nullopt;
  return trapeze::BenchArguments{argv[2], {argv + 3, argv + argc}};
}

/// For its help, and to report a missing name.
void add_bench(CLI::App& app, std::string& name) {
  CLI::App* bench =
      app.add_subcommand("bench", "Run a benchmark: trapeze bench NAME [OPTION OF NAME ...]");
  bench->footer(kBenchFooter);
  bench->add_option("NAME", name, "The benchmark; what follows it is for the benchmark")
      ->required();
}

void add_parameters(CLI::App& app) {
  app.add_subcommand("parameters", "Print what a style can say, as a table in Markdown");
}

/// The command whose options were read last, or the program if there was none.
const CLI::App& innermost(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : innermost(*chosen.front());
}

std::vector<std::string> command_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

/// Of the command and of the program.
std::vector<std::string> option_names(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* each : {&command, &app}) {
    for (const CLI::Option* option : each->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

/// "config print"; empty for the program itself.
std::string command_path(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  if (parent == nullptr) return "";
  const std::string above = command_path(*parent);
  return above.empty() ? command.get_name() : above + ' ' + command.get_name();
}

/// The problem with an argument that is left over after all known ones were parsed.
std::string unknown_problem(const CLI::App& app, const CLI::App& command,
                            const std::string& argument) {
  const std::string name = argument.substr(0, argument.find('='));
  if (name.starts_with('-')) {
    return "there is no option " + name + trapeze::did_you_mean(name, option_names(app, command));
  }
  const std::vector<std::string> commands = command_names(command);
  if (commands.empty()) return command_path(command) + " takes no further argument " + argument;
  return "there is no command " + argument + trapeze::did_you_mean(argument, commands);
}

/// The problem with known options. The parser reports the option only in its message, which begins
/// with or contains the option's name.
std::string option_problem(const CLI::App& app, const CLI::App& command,
                           const CLI::ParseError& error) {
  std::string words = error.what();
  if (command.get_require_subcommand_min() > 0 && command.get_subcommands().empty()) {
    return command_path(command) +
           " needs a command: " + CLI::detail::join(command_names(command), ", ");
  }
  for (const CLI::App* each : {&command, &app}) {
    for (const CLI::Option* option : each->get_options()) {
      const std::string name = option->get_name();
      if (words.starts_with(name + " is required")) return name + " is missing";
      if (words.starts_with("Could not convert: " + name + ' ')) return name + " takes no value";
      if (!words.starts_with(name + ':')) continue;
      if (option->count() > 1) return name + " is given more than once";
      return name + " needs a value, " + option->get_type_name();
    }
  }
  return words;
}

/// Reports what is wrong, what may have been meant, and where there is more to read.
std::string usage_problem(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  // Mistyped arguments come first: a missing required option may be a consequence.
  const std::vector<std::string> unknown = app.remaining(true);
  const std::string problem = unknown.empty() ? option_problem(app, command, error)
                                              : unknown_problem(app, command, unknown.front());
  const std::string path = command_path(command);
  const std::string who = path.empty() ? "trapeze" : "trapeze " + path;
  return problem + (problem.ends_with('?') ? " `" : "; `") + who + " --help` tells more";
}

int run(int argc, char** argv) {
  if (const auto benchmark = bench_arguments(argc, argv)) return trapeze::run_bench(*benchmark);
  CLI::App app(kDescription, "trapeze");
  app.require_subcommand(0, 1);  // a missing command is reported below, with the list of commands
  app.set_version_flag("--version", "trapeze " + trapeze::version());
  bool is_verbose = false;
  app.add_flag("--verbose", is_verbose, "Log every request");
  app.fallthrough();
  trapeze::ServeArguments serve;
  trapeze::CheckArguments check;
  trapeze::PrepareArguments prepare;
  trapeze::DiffArguments diff;
  trapeze::ExportArguments to_export;
  trapeze::RenderArguments render;
  trapeze::SeedArguments seed;
  std::string bench;
  std::string config_path;
  trapeze::ServeArguments config;
  add_serve(app, serve);
  add_config(app, config_path, config);
  add_check(app, check);
  add_prepare(app, prepare);
  add_diff(app, diff);
  add_export(app, to_export);
  add_render(app, render);
  add_seed(app, seed);
  add_bench(app, bench);
  add_parameters(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    throw trapeze::UsageError(usage_problem(app, error));
  }
  if (app.get_subcommands().empty()) {
    std::cerr << app.help();
    return kWrongUsage;
  }
  if (is_verbose) spdlog::set_level(spdlog::level::debug);
  serve.is_verbose = is_verbose;
  if (app.got_subcommand("serve")) return trapeze::run_serve(serve);
  if (app.got_subcommand("parameters")) {
    std::cout << trapeze::parameter_table();
    return 0;
  }
  if (const CLI::App* command = app.get_subcommand("config"); command->parsed()) {
    if (command->got_subcommand("check")) return trapeze::run_config_check(config_path);
    if (command->got_subcommand("print")) return trapeze::run_config_print(config);
    return trapeze::run_config_schema();
  }
  if (app.got_subcommand("bench")) return trapeze::run_bench({bench, {}});
  trapeze::end_cleanly_when_interrupted();
  if (app.got_subcommand("check")) return trapeze::run_check(check);
  if (app.got_subcommand("prepare")) return trapeze::run_prepare(prepare);
  if (app.got_subcommand("diff")) return trapeze::run_diff(diff);
  if (app.got_subcommand("export")) return trapeze::run_export(to_export);
  if (app.got_subcommand("seed")) {
    seed.words.assign(std::find(argv, argv + argc, std::string_view("seed")) + 1, argv + argc);
    return trapeze::run_seed(seed);
  }
  return trapeze::run_render(render);
}

/// The status of the command, or of a failure if not all of its results could be written, for
/// example to a full disk.
int status_with_results(int status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  std::cerr << "trapeze: standard output cannot be written: " << std::strerror(errno) << '\n';
  return status == 0 ? kFailed : status;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    trapeze::return_large_arrays();
    spdlog::set_default_logger(spdlog::stderr_logger_mt("trapeze"));
    spdlog::set_pattern(trapeze::kServerLogPattern);
    return status_with_results(run(argc, argv));
  } catch (const trapeze::UsageError& error) {
    std::cerr << "trapeze: " << error.what() << '\n';
    return kWrongUsage;
  } catch (const std::exception& error) {
    std::cerr << "trapeze: " << trapeze::failure_words(error) << '\n';
    return kFailed;
  }
}
