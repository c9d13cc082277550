#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "core/io/file/mapped_file.h"
#include "core/io/file/prepared_file.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/source/source_stamp.h"
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

/// The file to take over from, of `reuse`, that or a folder; empty if that has none of that name.
std::string earlier_file(const std::string& reuse, const std::string& output) {
  if (!std::filesystem::is_directory(reuse)) return reuse;
  const auto file = std::filesystem::path(reuse) / std::filesystem::path(output).filename();
  return std::filesystem::exists(file) ? file.string() : "";
}

/// What `reuse` has for the file; nothing, and why, if there is nothing to take over.
EarlierPrepared find_earlier(const std::string& reuse, const std::string& output,
                             const LayerOptions& options) {
  if (reuse.empty()) return {};
  const std::string file = earlier_file(reuse, output);
  if (file.empty()) return {nullptr, nullptr, "holds no file of that name"};
  if (!std::filesystem::exists(file)) throw std::runtime_error(file + ": there is no such file");
  if (!is_prepared_file(file)) throw std::runtime_error(file + ": is no prepared file");
  return open_earlier_layer(file, options);
}

LoadedLayer load(const std::string& file, const LoadOptions& how, const EarlierPrepared& earlier) {
  LoadProgress progress(file);
  LoadOptions options = how;
  options.earlier = earlier.layer;
  options.progress = [&progress](double share) { progress.show(share); };
  return load_layer(file, options);
}

void print_reuse(const std::string& reuse, const EarlierPrepared& earlier,
                 const LoadReport& report) {
  if (reuse.empty()) return;
  if (earlier.layer == nullptr) {
    fmt::print("  nothing is taken over: {} {}\n", reuse, earlier.unfit);
    return;
  }
  fmt::print("  {} of {} features are as they were and taken over from {}\n", report.taken_over,
             report.loaded, reuse);
}

void prepare(const std::string& file, const LoadOptions& how, SkipLimit max_skipped,
             const std::string& output, const std::string& reuse) {
  if (is_prepared_file(file)) {
    throw std::runtime_error(file + ": is a prepared file already; name what it was made from");
  }
  // Before the file is read, so that a change from here on is noticed now or later.
  const SourceStamp source = stamp_source(file);
  const EarlierPrepared earlier = find_earlier(reuse, output, how.generalization);
  const LoadedLayer loaded = load(file, how, earlier);
  if (earlier.file != nullptr && !earlier.file->is_whole()) {
    throw std::runtime_error(reuse + ": was written into while it was read");
  }
  const std::string change = change_since(source, file);
  if (!change.empty()) {
    throw std::runtime_error(file + ": has changed while it was read: " + change);
  }
  if (const std::string excess = find_excess(loaded.report, max_skipped); !excess.empty()) {
    throw std::runtime_error(excess + "; `trapeze check` tells which");
  }
  save_prepared_layer(output, loaded, revision_of(*loaded.layer), source);
  const LoadReport& report = loaded.report;
  fmt::print("{}: {} of {} features, {} vertices, {:.1f} MB, from {}\n", output, report.loaded,
             report.features, report.vertices,
             static_cast<double>(std::filesystem::file_size(output)) / 1e6, report.path);
  print_reuse(reuse, earlier, report);
  for (const std::string& warning : report.warnings) fmt::print("  warning: {}\n", warning);
  if (report.repaired > 0 || report.skipped > 0) {
    fmt::print("  {} features repaired, {} skipped; `trapeze check {}` tells which\n",
               report.repaired, report.skipped, output);
  }
  if (source.files.empty()) {
    fmt::print("  changes of {} will not be noticed: it is no file of this machine\n", source.path);
  }
}

}  // namespace

int run_prepare(const PrepareArguments& arguments) {
  LoadOptions how;
  how.generalization.weights = word_or_throw("--weights", arguments.weights, kWeightNames);
  apply(arguments.coverage, how.generalization);
  how.selection = arguments.selection;
  const std::vector<LayerConfig> layers = layers_or_throw(arguments.files);
  make_folder(arguments.output);
  bool is_all_prepared = true;
  for (const LayerConfig& layer : layers) {
    const auto output = std::filesystem::path(arguments.output) / (layer.name + kExtension);
    try {
      prepare(layer.file, how, arguments.max_skipped, output.string(), arguments.reuse);
    } catch (const std::exception& error) {
      // Reported here and not by main, so that the files after this one are prepared too.
      fmt::print(stderr, "trapeze: {}\n", error.what());
      is_all_prepared = false;
    }
  }
  return is_all_prepared ? 0 : 1;
}

}  // namespace trapeze
