// The command line: parses it, runs the command, reports errors.
#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
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
    R"(Trapeze serves polygon maps as PNG tiles and simplifies them while it draws.

Examples:
  trapeze serve countries.fgb lakes.gpkg      tiles at http://localhost:8080/tiles/countries,lakes/{z}/{x}/{y}.png
  trapeze serve --config trapeze.toml         layers, styles and titles from a configuration
  trapeze config check trapeze.toml           report all mistakes in a configuration
  trapeze check buildings.shp                 report the contents of a file and its errors
  trapeze prepare buildings.gpkg --output DIR          DIR/buildings.trapeze, which loads instantly
  trapeze diff old.trapeze parcels.gpkg --zooms 0-16   list the tiles that an edit has changed
  trapeze export countries.fgb --zoom 4 --output coarse.gpkg   the simplified polygons of a zoom
  trapeze render countries.fgb --tile 3/4/2 --style fill=teal --output tile.png
  trapeze seed countries.fgb --zooms 0-8 --output world.pmtiles   all tiles in one archive
  trapeze parameters                          a table of all style parameters

Exit status: 0 on success; 1 if something failed or is wrong, such as an unreadable file or a
port in use; 2 for a wrong command line; 130 or 143 if SIGINT or SIGTERM interrupted a command,
which never leaves a partially written file (`serve` shuts down cleanly, with status 0).
Results go to standard output; errors and the log go to standard error.)";

constexpr const char* kServeFooter = R"(
Examples:
  trapeze serve countries.fgb                 http://localhost:8080/tiles/countries/0/0/0.png
  trapeze serve --port 9000 --address 127.0.0.1 buildings.fgb water.fgb
  trapeze serve --config trapeze.toml --workers 4

URLs: /tiles/{layers}/{z}/{x}/{y}[@2x].png, /tiles/{layers}.json (TileJSON), /catalog, /health,
/ready, /metrics, and the viewer at /. SIGTERM and SIGINT shut the server down cleanly, SIGHUP
reloads configuration and layers.)";

constexpr const char* kConfigFooter = R"(
Examples:
  trapeze config check trapeze.toml           every mistake with its line and column
  trapeze config print --config trapeze.toml --port 9000
  trapeze config schema                       for completion and validation in editors

The command line overrides the environment (TRAPEZE_TABLE_KEY, such as TRAPEZE_SERVER_PORT for
server.port), which overrides the file. In strings of the file, ${NAME} is replaced by the
environment variable NAME.)";

constexpr const char* kCheckFooter = R"(
Examples:
  trapeze check countries.fgb buildings.shp
  trapeze check --strict delivery.gpkg
  trapeze check --list errors.geojson parcels.gpkg

The exit status is 1 if a file cannot be read, or if more features are skipped than
--max-skipped allows; repaired features and other skipped ones are only listed. --list writes
the places in FILE where polygons do not fit together: kind (gap or overlap), area in square
metres, width in metres, and the ids of the features.)";

constexpr const char* kSeedFooter = R"(
Examples:
  trapeze seed countries.fgb --zooms 0-8 --output world.pmtiles
  trapeze seed --config trapeze.toml --layers land,water --style style=night --zooms 0-14 \
    --bbox 14.1,35.7,14.6,36.1 --output malta.mbtiles
  trapeze seed --config trapeze.toml --zooms 0-14 --dry-run
  trapeze seed --config trapeze.toml --zooms 0-14 --part 3/8 --output world.part3
  trapeze seed --join world.part* --output world.pmtiles
  trapeze seed --config trapeze.toml --zooms 0-14 --output world.pmtiles --parts 8 \
    --jobs slurm >seed.sbatch

Tiles are byte for byte those of `trapeze serve` with the same options. Areas of a single colour
are recognised without drawing or visiting each of their tiles. Progress is kept in OUT.seeding
until the archive is complete: after an interruption, the same command resumes. The bytes of the
archive do not depend on interruptions, threads or parts.)";

constexpr const char* kPrepareFooter = R"(
Examples:
  trapeze prepare buildings.gpkg water.fgb --output prepared
  trapeze serve prepared/buildings.trapeze prepared/water.trapeze
  trapeze prepare buildings.gpkg --output prepared --reuse prepared
  trapeze prepare country.fgb --part 1-64/64 --output parts
  trapeze prepare country.fgb --part $SLURM_ARRAY_TASK_ID/64 --output parts
  trapeze prepare --join 'parts/*.trapeze' --output parts
  trapeze serve 'parts/*.trapeze'

A prepared file holds a layer in the form in which it is served. It is memory-mapped instead of
built, servers on one machine share its memory, and its tiles and ETags equal those of FILE. It
is rejected if it is damaged, if FILE has changed since, or if this version of Trapeze builds
layers differently; then prepare it again. It can be served without FILE. Preparing again
replaces the file safely under a running server; never modify it in any other way.

--part builds a layer in parts, on one machine or many, with the memory of one part. Every run
scans all of FILE and divides it by location in the same way; then it reads the features of its
own part, which is fast for a FlatGeobuf with a spatial index. Features near each other are in
the same part. All parts together are served as one layer. --join makes an overview of them,
which low zooms need; --part 1-N/N makes it too.)";

constexpr const char* kDiffFooter = R"(
Examples:
  trapeze diff yesterday.trapeze parcels.gpkg --zooms 0-16
  trapeze diff old.fgb new.fgb --zooms 12 --style 'color-by=use&classes=forest:green' --format json

OLD and NEW are two states of one layer, as source files or prepared files. A tile is listed if
the geometry or style it is drawn from has changed, so every tile with a changed picture is
listed. A few listed tiles may look the same, because the change is too small to be visible:
--certainty bytes draws both versions and lists only those that differ. --certainty candidates
does not examine single tiles: it lists those that may change in any style with the same
simplify, except styles that select features by id, labels that --style does not set, and wider
outlines or more smooth or grow than it sets. Use it to purge caches of all styles.)";

constexpr const char* kExportFooter = R"(
Examples:
  trapeze export countries.fgb --zoom 4 --output coarse.gpkg
  trapeze export buildings.shp --zoom 14 --simplify 2 --crs EPSG:3857 --output rough.fgb
  trapeze export landcover.gpkg --zoom 12 --smooth 8 --output smooth.gpkg
  trapeze export rivers.gpkg --zoom 9 --grow 3 --output wide.gpkg

Writes the simplified polygons that tiles of that zoom are drawn from, with their attributes.
The field trapeze_id holds the id of each feature in FILE. Features too small to remain at that
tolerance are omitted and counted. With --topology strict all polygons are valid, except for
those in degrees that are named as invalid.)";

constexpr const char* kRenderFooter = R"(
Examples:
  trapeze render countries.fgb --tile 3/4/2 --output tile.png
  trapeze render land.fgb lakes.fgb --tile 0/0/0 --scale 2 \
      --style 'lakes.fill=6fa8c9&background=white' --output world.png)";

constexpr const char* kBenchFooter = R"(
Examples:
  trapeze bench experiment                    the paper's experiment
  trapeze bench experiment --help             its options

Benchmarks are separate programs, trapeze-NAME in the folder bench beside this program, since
they need additional libraries. The release preset builds them.)";

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
    return help + ". Default: " + std::to_string(*number);
  }
  const auto& text = std::get<std::string>(value);
  return text.empty() ? help : help + ". Default: " + text;
}

trapeze::ConfigOverride parse_assignment(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  std::vector<std::string> known;
  for (const auto& setting : trapeze::config_settings()) known.push_back(setting.name());
  const bool is_known = std::ranges::find(known, name) != known.end();
  if (equals == std::string::npos || !is_known) {
    throw trapeze::UsageError("--set takes TABLE.KEY=VALUE of a setting, got \"" + text +
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
  add_number(
      command, "--max-skipped", "N",
      fmt::format("How many features of a layer may be skipped because they cannot be drawn, as a "
                  "number or as a share such as 1%; more are an error. Default: {}",
                  if_not_set),
      [&limit](const std::string& option, const std::string& text) {
        limit = trapeze::skip_limit_or_throw(option, text);
      });
  // Options take effect in the order in which they are added.
  command.add_flag_callback(
      "--strict", [&limit] { limit = trapeze::skip_limit_or_throw("--strict", "0"); },
      "Allow no skipped features; overrides --max-skipped");
}

void add_coverage(CLI::App& command, trapeze::CoverageArguments& coverage,
                  const std::string& if_not_set) {
  command
      .add_option("--coverage", coverage.mode,
                  fmt::format("Whether neighbouring polygons keep shared borders: auto, on or off, "
                              "as in the configuration of layers. Default: {}",
                              if_not_set))
      ->type_name("NAME");
  add_number(command, "--close-gaps", "METRES",
             "Close gaps and overlaps between polygons up to this width, in metres on the ground; "
             "not with --coverage off",
             [&coverage](const std::string& option, const std::string& text) {
               coverage.close_gaps = trapeze::number_or_throw(option, text, 0, trapeze::kWidestGap);
             });
  add_number(command, "--merge", "PIXELS",
             "Merge polygons closer than this distance into blocks, in pixels at the default "
             "simplify of 0.25; not with --coverage off",
             [&coverage](const std::string& option, const std::string& text) {
               coverage.merge = trapeze::number_or_throw(option, text, 0, trapeze::kWidestMerge);
             });
  command
      .add_option("--merge-by", coverage.merge_by,
                  "With --merge: merge only polygons with equal values of this attribute")
      ->type_name("ATTRIBUTE");
}

std::string usual_coverage() {
  return std::string(trapeze::kCoverageNames.name_of(trapeze::kUsualCoverage));
}

/// For commands that read files which may have been prepared.
std::string coverage_of_files() {
  return "the mode a file was prepared with, else " + usual_coverage();
}

/// For commands that draw: the layers, and the renderer.
void add_drawing_settings(CLI::App& command, trapeze::ServeArguments& arguments) {
  command.add_option("FILE", arguments.files,
                     "Polygon files in a format that GDAL reads, or prepared files; each becomes a "
                     "layer with the name of the file. A pattern such as 'parts/*.trapeze' names a "
                     "layer in parts. Replaces the layers of the configuration.");
  command
      .add_option("--config", arguments.config,
                  "Configuration file (TOML); options on the command line override it")
      ->type_name("FILE");
  add_coverage(command, arguments.coverage, "the configured mode, else " + coverage_of_files());
  add_max_skipped(command, arguments.max_skipped, "as configured");
  add_setting(command, arguments, "--workers", "server.workers", "N");
  add_setting(command, arguments, "--renderer", "server.renderer", "NAME");
  add_setting(command, arguments, "--device", "server.device", "DEVICE");
}

/// Options take effect in the order in which they are added: with this one last, it overrides the
/// options for single settings, whichever they are.
void add_set(CLI::App& command, trapeze::ServeArguments& arguments) {
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&arguments](const std::vector<std::string>& assignments) {
            for (const std::string& text : assignments) {
              arguments.settings.push_back(parse_assignment(text));
            }
          },
          "Any setting of the configuration, such as limits.connections=100; can be repeated, and "
          "overrides the options for single settings")
      ->type_name("TABLE.KEY=VALUE")
      ->allow_extra_args(false);
}

void add_settings(CLI::App& command, trapeze::ServeArguments& arguments) {
  add_drawing_settings(command, arguments);
  add_setting(command, arguments, "--port", "server.port", "N");
  add_setting(command, arguments, "--address", "server.address", "IP");
  add_setting(command, arguments, "--threads", "server.threads", "N");
  add_setting(command, arguments, "--web-root", "server.web_root", "DIR");
  add_set(command, arguments);
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
                       "Report all mistakes in a configuration and in the files that it refers to")
      ->add_option("FILE", path, "Configuration (TOML)")
      ->required();
  CLI::App* print = config->add_subcommand("print",
                                           "Print the configuration that `serve` would use with "
                                           "the same options, with the origin of each value");
  add_settings(*print, arguments);
  config->add_subcommand("schema", "Print the JSON Schema of configuration files");
}

void add_check(CLI::App& app, trapeze::CheckArguments& arguments) {
  CLI::App* check = app.add_subcommand("check", "Load files and report their contents and errors");
  check->footer(kCheckFooter);
  check->add_option("FILE", arguments.files, "Polygon files or prepared files")->required();
  add_coverage(*check, arguments.coverage, coverage_of_files());
  add_max_skipped(*check, arguments.max_skipped, "100%");
  check
      ->add_option("--list", arguments.list,
                   "Write the gaps and overlaps between the polygons of FILE to this file, with "
                   "area, width and feature ids: .geojson, .gpkg or .fgb")
      ->type_name("OUT");
  check->add_flag("--overwrite", arguments.overwrite, "Overwrite OUT if it exists");
}

void add_prepare(CLI::App& app, trapeze::PrepareArguments& arguments) {
  CLI::App* prepare =
      app.add_subcommand("prepare", "Save built layers in files that load instantly");
  prepare->footer(kPrepareFooter);
  prepare->add_option("FILE", arguments.files, "Polygon files in a format that GDAL reads");
  prepare
      ->add_option("--weights", arguments.weights,
                   fmt::format("How the importance of vertices is measured: {}. Default: {}",
                               trapeze::listed(trapeze::kWeightNames.names()), arguments.weights))
      ->type_name("NAME");
  add_coverage(*prepare, arguments.coverage, usual_coverage());
  prepare
      ->add_option("--source-layer", arguments.selection.layer,
                   "The layer or table of FILE. Default: all that contain polygons")
      ->type_name("NAME");
  prepare
      ->add_option("--where", arguments.selection.where,
                   "An SQL condition that selects features, such as \"height > 20\"")
      ->type_name("SQL");
  prepare
      ->add_option("--attributes", arguments.selection.attributes,
                   "The attributes to keep, separated by commas. Default: all")
      ->delimiter(',')
      ->allow_extra_args(false)  // what follows is a FILE
      ->type_name("NAME,...");
  add_max_skipped(*prepare, arguments.max_skipped, "100%");
  prepare
      ->add_option("--output", arguments.output,
                   "The folder for the prepared files, each named after FILE with the extension "
                   ".trapeze. With --join it may also be a file name with this extension")
      ->required()
      ->type_name("DIR");
  prepare
      ->add_option("--part", arguments.part,
                   "Prepare part I of N parts with about equal numbers of vertices; A-B/N prepares "
                   "parts A to B, one after the other")
      ->type_name("I/N");
  prepare
      ->add_option("--join", arguments.join, "Only make an overview of these parts, for low zooms")
      ->type_name("PART");
  prepare
      ->add_option("--crs", arguments.crs,
                   "Additional reference systems besides EPSG:3857, such as EPSG:2056; each gets "
                   "its own file with the extension .EPSG-2056.trapeze")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  prepare
      ->add_option(
          "--reuse", arguments.reuse,
          "A previously prepared file, or a folder of such files, which may be that of --output. "
          "Polygons and groups of polygons with shared borders that have not changed are copied "
          "from there, which is faster. The result is the same without it")
      ->type_name("OLD");
}

void add_diff(CLI::App& app, trapeze::DiffArguments& arguments) {
  CLI::App* diff =
      app.add_subcommand("diff", "List the tiles that differ between two states of a layer");
  diff->footer(kDiffFooter);
  diff->add_option("OLD", arguments.before, "A polygon file or a prepared file")->required();
  diff->add_option("NEW", arguments.after, "A later state of the same layer")->required();
  diff->add_option("--zooms", arguments.zooms, "The zooms to list, such as 0-16")
      ->required()
      ->type_name("A-B");
  diff->add_option("--style", arguments.style, "Style parameters, as in the query of a URL")
      ->type_name("QUERY");
  add_number(*diff, "--scale", "N", "Scale of the tile: its side divided by 256 pixels, 1 to 4",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.scale = trapeze::integer_or_throw(option, text, 1, 4);
             });
  add_coverage(*diff, arguments.coverage, coverage_of_files());
  diff->add_option(
          "--certainty", arguments.certainty,
          fmt::format("Which tiles to list: {}. Default: {}",
                      trapeze::listed(trapeze::kCertaintyNames.names()), arguments.certainty))
      ->type_name("NAME");
  diff->add_option("--format", arguments.format,
                   fmt::format("How to write the list: {}. Default: text, one line z/x/y per tile",
                               trapeze::listed(trapeze::kTileListNames.names())))
      ->type_name("NAME");
}

void add_export(CLI::App& app, trapeze::ExportArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "export", "Write the simplified polygons of a zoom to a file for other programs");
  command->footer(kExportFooter);
  command->add_option("FILE", arguments.file, "A polygon file")->required();
  add_number(*command, "--zoom", "Z", "The zoom whose polygons to write, 0 to 24",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.zoom = trapeze::integer_or_throw(option, text, 0, trapeze::kMaxZoom);
             })
      .required();
  add_number(*command, "--simplify", "PX",
             fmt::format(
                 "Simplification tolerance in pixels; 0 removes nothing. Default: {}, as for tiles",
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
                "Round corners as the style parameter smooth does, up to this many pixels along "
                "their edges, 0 to {}; holds all polygons in memory",
                arguments.smooth);
  add_reshaping("--grow", trapeze::ParameterId::grow,
                "Widen features narrower than this many pixels, as the style parameter grow does, "
                "0 to {}; not together with --smooth; holds all polygons in memory",
                arguments.grow);
  command
      ->add_option(
          "--topology", arguments.topology,
          fmt::format("The topology: {}. Default: {}. With fast, the test that prevents "
                      "self-crossing polygons is skipped and crossings are noded",
                      trapeze::listed(trapeze::kTopologyNames.names()), arguments.topology))
      ->type_name("NAME");
  command
      ->add_option("--weights", arguments.weights,
                   fmt::format("How the importance of vertices is measured: {}. Default: {}",
                               trapeze::listed(trapeze::kWeightNames.names()), arguments.weights))
      ->type_name("NAME");
  add_coverage(*command, arguments.coverage, usual_coverage());
  command
      ->add_option("--crs", arguments.crs,
                   "EPSG:4326 (degrees) or EPSG:3857 (Web Mercator metres). Default: EPSG:4326")
      ->type_name("NAME");
  command->add_flag("--overwrite", arguments.overwrite, "Overwrite OUT if it exists");
  command
      ->add_option("--output", arguments.output,
                   "The output file: .fgb (FlatGeobuf), .gpkg (GeoPackage) or .geojson (GeoJSON)")
      ->required()
      ->type_name("OUT");
}

void add_render(CLI::App& app, trapeze::RenderArguments& arguments) {
  CLI::App* render = app.add_subcommand("render", "Draw one tile to a file");
  render->footer(kRenderFooter);
  render
      ->add_option("FILE", arguments.files, "Polygon files, one layer each, the bottom layer first")
      ->required();
  render->add_option("--tile", arguments.tile, "Zoom, column and row of the tile")
      ->required()
      ->type_name("Z/X/Y");
  add_number(*render, "--scale", "N", "Scale of the tile: its side divided by 256 pixels, 1 to 4",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.scale = trapeze::integer_or_throw(option, text, 1, 4);
             });
  render->add_option("--style", arguments.style, "Style parameters, as in the query of a URL")
      ->type_name("QUERY");
  add_coverage(*render, arguments.coverage, coverage_of_files());
  render->add_option("--renderer", arguments.renderer, help_of("server.renderer"))
      ->type_name("NAME");
  render->add_option("--device", arguments.device, help_of("server.device"))->type_name("DEVICE");
  render->add_option("--output", arguments.output, "The output image: .png or .webp")
      ->required()
      ->type_name("F");
}

void add_seed(CLI::App& app, trapeze::SeedArguments& arguments) {
  CLI::App* seed =
      app.add_subcommand("seed", "Draw all tiles of an area into an archive or folder");
  seed->footer(kSeedFooter);
  add_drawing_settings(*seed, arguments.serve);
  add_set(*seed, arguments.serve);
  seed->add_option(
          "--layers", arguments.layers,
          "The layers of the tiles, separated by commas, the bottom layer first. Default: all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  seed->add_option("--style", arguments.style,
                   "Style parameters, as in the query of a URL, such as style=night&fill=teal")
      ->type_name("QUERY");
  seed->add_option("--zooms", arguments.zooms, "The zooms to seed, such as 0-14")->type_name("A-B");
  seed->add_option("--bbox", arguments.bbox,
                   "Seed only tiles that intersect this box, in degrees. Default: the whole world")
      ->type_name("W,S,E,N");
  add_number(*seed, "--scale", "N", "Scale of the tile: its side divided by 256 pixels, 1 to 4",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.scale = trapeze::integer_or_throw(option, text, 1, 4);
             });
  seed->add_option(
          "--format", arguments.format,
          fmt::format("The format of tiles: {}. Default: {}",
                      trapeze::listed(trapeze::kTileFormatNames.names()), arguments.format))
      ->type_name("NAME");
  seed->add_option("--output", arguments.output,
                   "The output archive, .pmtiles or .mbtiles; any other name is a folder, "
                   "OUT/{z}/{x}/{y}.png")
      ->type_name("OUT");
  seed->add_flag("--sparse", arguments.is_sparse,
                 "Omit tiles that show nothing; in a folder they are always omitted");
  seed->add_flag("--dry-run", arguments.is_dry_run,
                 "Only estimate the number of tiles to draw, their size and the time");
  seed->add_option(
          "--update", arguments.update,
          "A previously seeded PMTiles archive, which may be that of --output. Tiles that have not "
          "changed are copied from there, which is faster. The result is the same without it")
      ->type_name("OLD");
  seed->add_option("--part", arguments.part,
                   "Seed part I of N parts of about equal cost; OUT is then an input for --join")
      ->type_name("I/N");
  seed->add_option("--join", arguments.join, "Only join these parts into the archive")
      ->type_name("PART");
  seed->add_option(
          "--jobs", arguments.jobs,
          fmt::format(
              "Only print a batch job that seeds the archive in --parts on many machines: {}",
              trapeze::listed(trapeze::kBatchSystemNames.names())))
      ->type_name("SYSTEM");
  add_number(*seed, "--parts", "N", "The number of parts for --jobs",
             [&arguments](const std::string& option, const std::string& text) {
               arguments.parts =
                   trapeze::integer_or_throw(option, text, 1, trapeze::kMostBatchParts);
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
  bench->add_option("NAME", name, "The benchmark; further arguments are passed to it")->required();
}

void add_parameters(CLI::App& app) {
  app.add_subcommand("parameters", "Print a table of all style parameters, in Markdown");
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
    const std::vector<std::string> names = option_names(app, command);
    if (std::ranges::find(names, name) != names.end()) {
      return name + " belongs behind " + command_path(command);
    }
    return "there is no option " + name + trapeze::did_you_mean(name, names);
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

/// Opens standard streams that are closed, so that no file that the program writes gets their
/// descriptors: its own log would be written into it. Writing results still fails.
void open_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    // The lowest free descriptor, which is this one.
    [[maybe_unused]] const int opened =
        open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
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
  open_standard_streams();
  // At a limit on the size of files (`ulimit -f`), writing fails as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
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
