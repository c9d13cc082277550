#include "server/service/config_check.h"

#include <spdlog/fmt/fmt.h>

#include <exception>
#include <optional>
#include <utility>

#include "core/io/file/prepared_file.h"
#include "core/io/prepared/prepared_parts.h"
#include "render/make_renderer.h"
#include "server/base/failure_words.h"
#include "server/data/dataset.h"
#include "server/data/layer_problems.h"
#include "server/data/named_tables.h"
#include "server/http/http_server.h"
#include "server/http/static_files.h"
#include "server/service/line_writer.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/read_tile_matrix_set.h"

namespace trapeze {
namespace {

/// The message of what `act` throws; empty if it does not throw.
template <typename Act>
std::string failure_of(const Act& act) {
  try {
    act();
    return {};
  } catch (const std::exception& error) {
    return failure_words(error);
  }
}

/// Checks the settings in the order in which the server would use them.
class ConfigCheck {
 public:
  ConfigCheck(const LoadedConfig& loaded, const std::string& path)
      : loaded_(loaded), config_(loaded.config), path_(path) {
    findings_.problems = loaded.problems;
  }

  ConfigFindings run() {
    check_files();
    check_renderer();
    check_addresses();
    if (!config_.changes.command.empty() && config_.changes.zooms.empty()) {
      findings_.warnings.push_back(
          found("changes.command", "is never run: it needs changes.zooms"));
    }
    for (const auto& [name, table] : config_.values) {
      if (!table.file.empty()) note(fmt::format("values.{}.file", name), find_table_problem(table));
    }
    for (const auto& [name, style] : config_.styles) check_names("styles." + name, style);
    for (const LayerConfig& layer : config_.layers) {
      check_names(fmt::format("layer.{}.style", layer.name), layer.style);
      check_own_style(layer);
      for (const LayerConfig& on_grid : with_grids({layer})) {
        // All grids share a source.
        const bool is_own = on_grid.grid.empty() || on_grid.file_to_open() != layer.file_to_open();
        if (is_own) check_layer(on_grid);
      }
    }
    if (config_.layers.empty() && findings_.problems.empty()) {
      findings_.warnings.push_back(
          {path_, "there is no [[layer]]: `trapeze serve` needs the names of files as well"});
    }
    return std::move(findings_);
  }

 private:
  ConfigProblem found(const std::string& setting, const std::string& what,
                      std::optional<std::size_t> item = {}) const {
    const bool is_told = loaded_.origins.contains(setting);
    return {is_told ? loaded_.origin_of(setting, item) : path_,
            fmt::format("{}: {}", setting, what)};
  }

  void note(const std::string& setting, const std::string& failure) {
    if (!failure.empty()) findings_.problems.push_back(found(setting, failure));
  }

  void check_files() {
    if (!config_.log.access.empty()) {
      note("log.access", find_target_problem(config_.log.access));
    }
    if (!config_.server.web_root.empty()) {
      note("server.web_root", failure_of([this] { StaticFiles(config_.server.web_root); }));
    }
    note("server.tile_matrix_sets",
         failure_of([this] { tile_matrix_sets_with(config_.server.tile_matrix_sets); }));
    check_fonts("text.fonts", config_.text.fonts);
    for (const auto& [name, fonts] : config_.fonts) {
      check_fonts(fmt::format("fonts.{}.files", name), fonts.files);
    }
  }

  void check_fonts(const std::string& setting, const std::vector<std::string>& files) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      for (const std::string& problem : find_font_problems({files[i]})) {
        findings_.warnings.push_back(found(setting, problem, i));
      }
    }
  }

  void check_renderer() {
    if (config_.server.renderer.kind == RendererKind::automatic) return;  // one always works
    note("server.renderer", failure_of([this] { make_renderer(config_.server.renderer); }));
  }

  void check_addresses() {
    check_address("server.address", config_.server.address);
    note("server.port", find_port_problem(config_.server.address, config_.server.port));
    if (config_.admin.port == 0) return;
    check_address("admin.address", config_.admin.address);
    note("admin.port", find_port_problem(config_.admin.address, config_.admin.port));
    const bool is_same = config_.admin.address == config_.server.address ||
                         is_among(config_.admin.address, config_.server.address) ||
                         is_among(config_.server.address, config_.admin.address);
    if (is_same && config_.admin.port == config_.server.port) {
      note("admin.port", "is the port of the server: each address needs one of its own");
    }
  }

  void check_address(const std::string& setting, const std::string& address) {
    HttpServerOptions options;
    options.address = address;
    options.port = 0;  // any: the configured port may be in use by a running server
    note(setting, failure_of([&options] { HttpServer(options, {}); }));
  }

  /// "::" are all addresses, "0.0.0.0" those of IPv4, which have a '.' in IPv6, too.
  static bool is_among(const std::string& address, const std::string& all) {
    return all == "::" || (all == "0.0.0.0" && address.find('.') != std::string::npos);
  }

  /// A style that names missing tables or fonts draws nothing.
  void check_names(const std::string& setting, const StyleQuery& style) {
    for (const StyleSetting& each : style.settings()) {
      if (each.parameter == ParameterId::label_font &&
          !config_.fonts.contains(std::get<std::string>(each.value))) {
        note(setting, fmt::format("there are no fonts [fonts.{}]", format_value(each.value)));
      }
      const auto* choice = std::get_if<TableChoice>(&each.value);
      if (choice == nullptr || config_.values.contains(choice->name)) continue;
      note(setting, fmt::format("there is no table [values.{}]", choice->name));
    }
  }

  /// Parameters with which every tile in the layer's own style would be refused, as far as they can
  /// be known without its attributes.
  void check_own_style(const LayerConfig& layer) {
    const std::string setting = fmt::format("layer.{}.style", layer.name);
    const auto sets = [&layer](ParameterId parameter) {
      const ParameterValue* value = layer.style.find(layer.name, parameter);
      return value != nullptr && *value != ParameterValue(0.0);
    };
    if (sets(ParameterId::grow) && sets(ParameterId::smooth)) {
      note(setting, "grow and smooth exclude each other");
    }
    const bool is_merged = layer.merge.value_or(0) > 0 || !layer.prepared.empty() ||
                           is_prepared_file(layer.file) || is_pattern_of_files(layer.file);
    if (sets(ParameterId::merge) && !is_merged) {
      note(setting, "merge is only for layers with merge, the distance they are built for");
    }
  }

  void check_layer(const LayerConfig& layer) {
    if (layer.file_to_open().empty()) return;  // already a problem of reading the configuration
    // Its name may be missing or wrong, which is a problem of reading the configuration too.
    const std::string table = layer.name.empty() ? "layer" : fmt::format("layer.{}", layer.name);
    for (const LayerProblem& problem : find_layer_problems(layer)) {
      auto& list = problem.is_warning ? findings_.warnings : findings_.problems;
      list.push_back(found(fmt::format("{}.{}", table, problem.key), problem.what, problem.index));
    }
  }

  const LoadedConfig& loaded_;
  const Config& config_;
  const std::string& path_;
  ConfigFindings findings_;
};

}  // namespace

ConfigFindings check_config(const LoadedConfig& loaded, const std::string& path) {
  return ConfigCheck(loaded, path).run();
}

}  // namespace trapeze
