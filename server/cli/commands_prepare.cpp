#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/file/mapped_file.h"
#include "core/io/file/prepared_file.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/source/source_stamp.h"
#include "core/io/source/target_grid.h"
#include "server/cli/commands.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"
#include "server/data/load_progress.h"

namespace trapeze {
namespace {

constexpr const char* kExtension = ".trapeze";

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(folder)) return;
  if (std::filesystem::exists(folder)) {
    throw UsageError(fmt::format("--output takes a folder; {} is a file", folder));
  }
  throw std::runtime_error(
      fmt::format("the folder {} cannot be made: {}", folder, error.message()));
}

/// The file to take over from: `reuse` itself, or the one for that output in the folder.
std::string earlier_file(const std::string& reuse, const std::string& output) {
  if (reuse.empty() || !std::filesystem::is_directory(reuse)) return reuse;
  return (std::filesystem::path(reuse) / std::filesystem::path(output).filename()).string();
}

/// Nothing, and why, if there is nothing to take over from the file; it may be missing in a folder.
EarlierPrepared open_earlier(const std::string& file, const std::string& reuse,
                             const LayerOptions& options, const std::string& grid) {
  if (file.empty()) return {};
  if (!std::filesystem::exists(file)) {
    if (file != reuse) return {nullptr, nullptr, "is not there"};
    throw std::runtime_error(file + ": there is no such file to take over from");
  }
  if (!is_prepared_file(file)) {
    throw std::runtime_error(file + ": is no prepared file to take over from");
  }
  return open_earlier_layer(file, options, grid);
}

LoadedLayer load(const std::string& file, const LoadOptions& how, const EarlierPrepared& earlier) {
  LoadProgress progress(file);
  LoadOptions options = how;
  options.earlier = earlier.layer;
  options.progress = [&progress](double share) { progress.show(share); };
  return load_layer(file, options);
}

void print_reuse(const std::string& file, const EarlierPrepared& earlier,
                 const LoadReport& report) {
  if (file.empty()) return;
  if (earlier.layer == nullptr) {
    fmt::print("  nothing is taken over: {} {}\n", file, earlier.unfit);
    return;
  }
  fmt::print("  {} of {} features are as they were and taken over from {}\n", report.taken_over,
             report.loaded, file);
}

void prepare(const std::string& file, const LoadOptions& how, SkipLimit max_skipped,
             const std::string& output, const std::string& reuse) {
  if (is_prepared_file(file)) {
    throw std::runtime_error(file + ": is a prepared file already; name what it was made from");
  }
  // Before the file is read, so that a change from here on is noticed now or later.
  const SourceStamp source = stamp_source(file);
  const std::string earlier_name = earlier_file(reuse, output);
  const EarlierPrepared earlier = open_earlier(earlier_name, reuse, how.generalization, how.grid);
  const LoadedLayer loaded = load(file, how, earlier);
  if (earlier.file != nullptr && !earlier.file->is_whole()) {
    throw std::runtime_error(earlier_name + ": was written into while it was read");
  }
  const std::string change = change_since(source, file);
  if (!change.empty()) {
    throw std::runtime_error(file + ": has changed while it was read: " + change);
  }
  if (const std::string excess = find_excess(loaded.report, max_skipped); !excess.empty()) {
    throw std::runtime_error(excess + "; `trapeze check` tells which");
  }
  save_prepared_layer(output, loaded, revision_of(*loaded.layer), source, how.grid);
  const LoadReport& report = loaded.report;
  fmt::print("{}: {} of {} features, {} vertices, {:.1f} MB, from {}\n", output, report.loaded,
             report.features, report.vertices,
             static_cast<double>(std::filesystem::file_size(output)) / 1e6, report.path);
  print_reuse(earlier_name, earlier, report);
  for (const std::string& warning : report.warnings) fmt::print("  warning: {}\n", warning);
  if (report.repaired > 0 || report.skipped > 0) {
    fmt::print("  {} features repaired, {} skipped; `trapeze check {}` tells which\n",
               report.repaired, report.skipped, output);
  }
  if (source.files.empty()) {
    fmt::print("  changes of {} will not be noticed: it is no file of this machine\n", source.path);
  }
}

/// That of Web Mercator, which has no name, and those of the systems.
std::vector<std::string> grids_or_throw(const std::vector<std::string>& names) {
  std::vector<std::string> grids = {""};
  for (const std::string& name : names) {
    if (name == kBuiltCrs) continue;
    try {
      find_target_grid(name);
    } catch (const std::exception& error) {
      throw UsageError(fmt::format("--crs: {}", error.what()));
    }
    grids.push_back(name);
  }
  return grids;
}

}  // namespace

int run_prepare(const PrepareArguments& arguments) {
  LoadOptions how;
  how.generalization.weights = word_or_throw("--weights", arguments.weights, kWeightNames);
  apply(arguments.coverage, how.generalization);
  how.selection = arguments.selection;
  const std::vector<LayerConfig> layers = layers_or_throw(arguments.files);
  const std::vector<std::string> grids = grids_or_throw(arguments.crs);
  make_folder(arguments.output);
  bool is_all_prepared = true;
  for (const LayerConfig& layer : layers) {
    const auto output = std::filesystem::path(arguments.output) / (layer.name + kExtension);
    for (const std::string& grid : grids) {
      try {
        how.grid = grid;
        prepare(layer.file, how, arguments.max_skipped,
                grid.empty() ? output.string() : prepared_on_grid(output.string(), grid),
                arguments.reuse);
      } catch (const std::exception& error) {
        // Reported here and not by main, so that the files after this one are prepared too.
        fmt::print(stderr, "trapeze: {}\n", error.what());
        is_all_prepared = false;
      }
    }
  }
  return is_all_prepared ? 0 : 1;
}

}  // namespace trapeze
