#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/prepared/prepared_parts.h"
#include "server/base/build_id.h"
#include "server/cli/commands.h"
#include "server/config/config_settings.h"
#include "server/config/load_config.h"
#include "server/service/server_log.h"
#include "server/service/service.h"

namespace trapeze {
namespace {

/// Layers are neither drawn nor announced beyond the last zoom that the server answers.
void limit_zooms(std::vector<LayerConfig>& layers, int last) {
  for (LayerConfig& layer : layers) {
    layer.max_zoom = std::max(layer.min_zoom, std::min(layer.max_zoom, last));
  }
}

bool is_of_command_line(const ConfigProblem& problem) {
  return problem.where.starts_with("--");
}

void throw_if_any(const std::vector<ConfigProblem>& problems) {
  if (problems.empty()) return;
  const std::string text = problems_text(problems);
  if (std::ranges::all_of(problems, is_of_command_line)) throw UsageError(text);
  throw std::runtime_error(text);
}

/// Replaces the layers of the configuration.
void take_files(const std::vector<std::string>& files, LoadedConfig& loaded) {
  loaded.config.layers = layers_or_throw(files);
  std::erase_if(loaded.origins,
                [](const auto& origin) { return origin.first.starts_with("layer."); });
  for (const LayerConfig& layer : loaded.config.layers) {
    for (const char* key : {"name", "file", "title"}) {
      loaded.origins[fmt::format("layer.{}.{}", layer.name, key)] = "FILE";
    }
  }
}

/// Applies to all layers.
void limit_skipped(SkipLimit limit, LoadedConfig& loaded) {
  for (LayerConfig& layer : loaded.config.layers) {
    layer.max_skipped = limit;
    loaded.origins[fmt::format("layer.{}.max_skipped", layer.name)] = "--max-skipped";
  }
}

/// Applies to all layers.
void share_borders(const CoverageArguments& coverage, LoadedConfig& loaded) {
  for (LayerConfig& layer : loaded.config.layers) {
    apply(coverage, layer);
    const auto note = [&](const char* key, const char* option, bool is_given) {
      if (is_given) loaded.origins[fmt::format("layer.{}.{}", layer.name, key)] = option;
    };
    note("coverage", "--coverage", !coverage.mode.empty());
    note("close_gaps", "--close-gaps", coverage.close_gaps.has_value());
    note("merge", "--merge", coverage.merge.has_value());
    note("merge_by", "--merge-by", !coverage.merge_by.empty());
  }
}

/// Finds missing files before the socket is opened, instead of after the other files have been
/// loaded.
void check_files_exist(const std::vector<LayerConfig>& layers) {
  for (const LayerConfig& layer : layers) {
    const std::string& file = layer.file_to_open();
    std::error_code error;
    if (is_pattern_of_files(file)) {
      files_of_pattern(file);  // throws if there are none
    } else if (is_file_path(file) && !std::filesystem::exists(file, error)) {
      throw std::runtime_error(
          error ? fmt::format("layer \"{}\": {}: {}", layer.name, file, error.message())
                : fmt::format("layer \"{}\": there is no file {}", layer.name, file));
    }
  }
}

void warn_of_other_changes(const Config& running, const Config& now) {
  for (const auto& setting : config_settings()) {
    if (setting.get(running) == setting.get(now)) continue;
    spdlog::warn(fmt::format("{} has changed: restart the server to apply it", setting.name()));
  }
  const auto is_same = [](const auto& a, const auto& b) {
    return a.first == b.first && a.second.canonical_text() == b.second.canonical_text();
  };
  if (!std::ranges::equal(running.styles, now.styles, is_same)) {
    spdlog::warn("styles have changed: restart the server to apply them");
  }
  const auto has_same_files = [](const auto& a, const auto& b) {
    return a.first == b.first && a.second.files == b.second.files;
  };
  if (!std::ranges::equal(running.fonts, now.fonts, has_same_files)) {
    spdlog::warn("fonts have changed: restart the server to apply them");
  }
}

Config with_layers(const ServeArguments& arguments) {
  LoadedConfig loaded = load_serve_config(arguments);
  if (loaded.config.layers.empty()) {
    throw UsageError(
        arguments.config.empty()
            ? "there are no layers: name files, or a configuration with [[layer]] in --config"
            : "there are no layers: name files, or a [[layer]] in " + arguments.config);
  }
  return std::move(loaded.config);
}

LayerSource layer_source(const ServeArguments& arguments, const Config& running) {
  using ValueTables = std::map<std::string, ValueTableConfig>;
  const auto values = std::make_shared<ValueTables>();
  const auto layers = [arguments, running, values] {
    Config now = with_layers(arguments);
    // The server keeps its limit until it is restarted.
    limit_zooms(now.layers, running.limits.zoom);
    check_files_exist(now.layers);
    warn_of_other_changes(running, now);
    *values = std::move(now.values);
    return std::move(now.layers);
  };
  return {layers, arguments.config, [values] { return *values; }};
}

/// Blocks signals that must not get lost before something acts on them, also in threads started
/// later, or lets blocked ones through to the calling thread.
void hold_signals(int how) {
  sigset_t held;
  sigemptyset(&held);
  // It would end the server; and systemd does not restart what it ends.
  sigaddset(&held, SIGHUP);
  // In a container: Linux discards signals to process 1 if nothing acts on them.
  if (getpid() == 1) {
    for (const int signal : {SIGINT, SIGTERM}) sigaddset(&held, signal);
  }
  pthread_sigmask(how, &held, nullptr);
}

[[noreturn]] void end_now(ServerLog& log) {
  // Neither reading a large file, nor placing its labels, nor waiting for a database can be
  // interrupted, and the result is not needed any more. Objects must not be destroyed while the
  // thread that reads or places uses them, so none are destroyed.
  spdlog::info("stopped while loading or placing labels");
  log.flush();
  std::quick_exit(0);
}

}  // namespace

LoadedConfig load_serve_config(const ServeArguments& arguments) {
  std::vector<ConfigOverride> overrides = environment_overrides(environ);
  overrides.insert(overrides.end(), arguments.settings.begin(), arguments.settings.end());
  LoadedConfig loaded = load_config(arguments.config, overrides);
  throw_if_any(loaded.problems);
  if (!arguments.files.empty()) take_files(arguments.files, loaded);
  share_borders(arguments.coverage, loaded);
  if (arguments.max_skipped) limit_skipped(*arguments.max_skipped, loaded);
  return loaded;
}

Config configure(const ServeArguments& arguments) {
  Config config = with_layers(arguments);
  limit_zooms(config.layers, config.limits.zoom);
  return config;
}

int run_serve(const ServeArguments& arguments) {
  // The server continues when the reader of its log exits.
  std::signal(SIGPIPE, SIG_IGN);
  hold_signals(SIG_BLOCK);
  ServerLog log;
  const Config config = configure(arguments);
  if (!arguments.is_verbose) spdlog::set_level(spdlog::level::from_str(config.log.level));
  spdlog::info(fmt::format("trapeze {} (build {})", version(), build_id()));
  if (!arguments.config.empty()) spdlog::info(fmt::format("configuration: {}", arguments.config));
  check_files_exist(config.layers);
  Service service(config, layer_source(arguments, config));
  service.act_on_signals();
  hold_signals(SIG_UNBLOCK);
  service.run();
  if (!service.finish()) end_now(log);
  spdlog::info("stopped");
  return 0;
}

}  // namespace trapeze
