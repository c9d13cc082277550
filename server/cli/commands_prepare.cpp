#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/io/file/prepared_file.h"
#include "core/io/load/source_division.h"
#include "core/io/prepared/join_parts.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/prepared/prepared_parts.h"
#include "core/io/source/source_stamp.h"
#include "core/io/source/target_grid.h"
#include "server/base/failure_words.h"
#include "server/cli/commands.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"
#include "server/data/load_progress.h"
#include "server/seed/seed_jobs.h"

namespace trapeze {
namespace {

constexpr const char* kExtension = ".trapeze";

/// The range of parts to prepare, and the number of all parts.
struct PartRange {
  std::uint32_t first = 1;
  std::uint32_t last = 1;
  std::uint32_t count = 1;

  bool is_all() const { return first == 1 && last == count; }
};

/// Parses "I/N" or "A-B/N".
PartRange parts_or_throw(const std::string& text) {
  const auto wrong = [&text] {
    return UsageError(fmt::format(
        "--part takes I/N, I being from 1 to N, or A-B/N for several, got \"{}\"", text));
  };
  const std::size_t slash = text.find('/');
  const std::size_t dash = text.find('-');
  if (slash == std::string::npos) throw wrong();
  const bool is_range = dash < slash;
  const auto first = parse_part(is_range ? text.substr(0, dash) + text.substr(slash) : text);
  const auto last = is_range ? parse_part(text.substr(dash + 1)) : first;
  if (!first || !last || first->number > last->number) throw wrong();
  if (first->count > kMostParts) {
    throw UsageError(fmt::format("--part takes {} parts at most, got \"{}\"", kMostParts, text));
  }
  return {static_cast<std::uint32_t>(first->number), static_cast<std::uint32_t>(last->number),
          static_cast<std::uint32_t>(first->count)};
}

/// For example "buildings-03-of-12.trapeze".
std::string name_of_part(const std::string& layer, std::uint32_t part, std::uint32_t count) {
  const std::string of = std::to_string(count);
  return fmt::format("{}-{:0{}}-of-{}{}", layer, part, of.size(), of, kExtension);
}

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

/// The file to reuse: `reuse` itself, or the file for that output in the folder.
std::string earlier_file(const std::string& reuse, const std::string& output) {
  if (reuse.empty() || !std::filesystem::is_directory(reuse)) return reuse;
  return (std::filesystem::path(reuse) / std::filesystem::path(output).filename()).string();
}

/// Returns nothing, with the reason, if the file has nothing to reuse; in a folder, it may be
/// missing.
EarlierPrepared open_earlier(const std::string& file, const std::string& reuse,
                             const LayerOptions& options, const std::string& grid) {
  if (file.empty()) return {};
  if (!std::filesystem::exists(file)) {
    if (file != reuse) return {nullptr, nullptr, {}, "is not there", file};
    throw std::runtime_error(file + ": no such file to reuse");
  }
  if (!is_prepared_file(file)) {
    throw std::runtime_error(file + ": not a prepared file, cannot be reused");
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

void print_reuse(const EarlierPrepared& earlier, const LoadReport& report) {
  if (earlier.path.empty()) return;
  if (earlier.layer == nullptr) {
    fmt::print("  nothing is reused: {} {}\n", earlier.path, earlier.unfit);
    return;
  }
  fmt::print("  {} of {} features are unchanged and reused from {}\n", report.taken_over,
             report.loaded, earlier.path);
}

/// Taken before the file is read, so that a change from here on is noticed now or later.
SourceStamp stamp_or_throw(const std::string& file) {
  if (is_prepared_file(file)) {
    throw std::runtime_error(file + ": already a prepared file; name its source instead");
  }
  return stamp_source(file);
}

void prepare(const std::string& file, const SourceStamp& source, const LoadOptions& how,
             SkipLimit max_skipped, const std::string& output, const std::string& reuse) {
  const EarlierPrepared earlier =
      open_earlier(earlier_file(reuse, output), reuse, how.generalization, how.grid);
  const LoadedLayer loaded = load(file, how, earlier);
  const std::string change = change_since(source, file);
  if (!change.empty()) {
    throw std::runtime_error(file + ": changed while it was being read: " + change);
  }
  if (const std::string excess = find_excess(loaded.report, max_skipped); !excess.empty()) {
    throw std::runtime_error(excess + "; `trapeze check` lists them");
  }
  save_prepared_layer(output, loaded, revision_of(*loaded.layer), source, how.grid, earlier);
  const LoadReport& report = loaded.report;
  fmt::print("{}: {} of {} features, {} vertices, {:.1f} MB, from {}\n", output, report.loaded,
             report.features, report.vertices,
             static_cast<double>(std::filesystem::file_size(output)) / 1e6, report.path);
  print_reuse(earlier, report);
  for (const std::string& warning : report.warnings) fmt::print("  warning: {}\n", warning);
  if (report.repaired > 0 || report.skipped > 0) {
    fmt::print("  {} features repaired, {} skipped; `trapeze check {}` lists them\n",
               report.repaired, report.skipped, output);
  }
  if (source.files.empty()) {
    fmt::print("  changes of {} will not be noticed: it is not a file on this machine\n",
               source.path);
  }
}

std::shared_ptr<const SourceDivision> divide(const std::string& file, const LoadOptions& how,
                                             std::uint32_t count) {
  std::shared_ptr<const SourceDivision> division;
  {
    LoadProgress progress(file);
    division = SourceDivision::of(file, how.selection, how.generalization, count,
                                  [&progress](double share) { progress.show(share); });
  }
  std::uint64_t vertices = 0;
  std::uint64_t most = 0;
  std::size_t features = 0;
  for (const SourceDivision::Part& part : division->parts()) {
    vertices += part.vertices;
    most = std::max(most, part.vertices);
    features += part.features;
  }
  fmt::print("{}: {} features with {} vertices in {} parts, of which the largest has {}\n", file,
             features, vertices, count, most);
  if (most > 2 * (vertices / count) && division->largest_group() > most / 2) {
    fmt::print(
        "  warning: {} of these vertices belong to features near each other, which cannot be split "
        "across parts\n",
        division->largest_group());
  }
  return division;
}

/// Writes the overview of these parts to that file.
void join(const std::vector<std::string>& files, const std::string& output) {
  const auto parts = find_prepared_parts(files, {});
  for (const auto& part : parts) {
    std::error_code error;
    if (std::filesystem::equivalent(part->path(), output, error)) {
      throw UsageError(
          fmt::format("--output: {} is a part, which the overview would replace", output));
    }
  }
  LoadedLayer overview;
  {
    LoadProgress progress(output);
    overview = overview_of(parts, [&progress](double share) { progress.show(share); });
  }
  save_prepared_layer(output, overview, revision_of(*overview.layer),
                      parts.front()->summary().source);
  fmt::print("{}: the overview of {} parts, {} features, {} motes, {:.1f} MB\n", output,
             parts.size(), overview.report.loaded, overview.layer->size().motes,
             static_cast<double>(std::filesystem::file_size(output)) / 1e6);
}

/// The file of the overview of parts of that source in that folder: one that is there already,
/// which the new one replaces, as there can be only one beside the parts.
std::filesystem::path overview_of_source(const std::filesystem::path& folder,
                                         const SourceStamp& source, const std::string& layer) {
  for (const std::string& file :
       files_of_pattern((folder / ("*" + std::string(kExtension))).string())) {
    if (!is_prepared_file(file)) continue;
    try {
      const PreparedSummary summary = read_prepared_summary(file);
      const bool is_overview = summary.part && summary.part->is_overview();
      if (is_overview && summary.source.path == source.path) return file;
    } catch (const std::exception&) {  // damaged, or of another version: whatever it is
      continue;
    }
  }
  return folder / (layer + "-overview" + kExtension);
}

/// Prepares some of the parts of a file, and an overview if they are all of them.
void prepare_parts(const LayerConfig& layer, const LoadOptions& how, const PartRange& range,
                   const PrepareArguments& arguments) {
  const SourceStamp source = stamp_or_throw(layer.file);
  LoadOptions of_part = how;
  of_part.division = divide(layer.file, how, range.count);
  const std::filesystem::path folder = arguments.output;
  std::vector<std::string> files;
  for (of_part.part = range.first; of_part.part <= range.last; ++of_part.part) {
    files.push_back((folder / name_of_part(layer.name, of_part.part, range.count)).string());
    prepare(layer.file, source, of_part, arguments.max_skipped, files.back(), arguments.reuse);
  }
  if (range.is_all()) join(files, overview_of_source(folder, source, layer.name).string());
}

/// The file of an overview in that folder: one among these files, which the new one replaces, as
/// there can be only one beside the parts.
std::filesystem::path overview_in(const std::filesystem::path& folder,
                                  const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    if (!is_prepared_file(file)) continue;
    const auto part = read_prepared_summary(file).part;
    const auto beside = std::filesystem::absolute(file).parent_path();
    std::error_code error;
    if (part && part->is_overview() && std::filesystem::equivalent(beside, folder, error)) {
      return file;
    }
  }
  return folder / (std::string("overview") + kExtension);
}

int run_join(const PrepareArguments& arguments) {
  if (!arguments.files.empty()) throw UsageError("--join takes parts and no FILE");
  if (!arguments.part.empty()) throw UsageError("--join and --part exclude each other");
  const CoverageArguments& coverage = arguments.coverage;
  const bool is_built = !arguments.selection.is_all() || !arguments.crs.empty() ||
                        !arguments.reuse.empty() || !coverage.mode.empty() || coverage.close_gaps ||
                        coverage.merge || !coverage.merge_by.empty();
  if (is_built) throw UsageError("--join takes no options for building: parts stay as they are");
  std::vector<std::string> files;
  for (const std::string& name : arguments.join) {
    for (const std::string& file :
         is_pattern_of_files(name) ? files_of_pattern(name) : std::vector<std::string>{name}) {
      files.push_back(file);
    }
  }
  std::filesystem::path output = arguments.output;
  if (output.extension() != kExtension) {
    make_folder(arguments.output);
    output = overview_in(output, files);
  }
  join(files, output.string());
  return 0;
}

/// The grid of Web Mercator, which has no name, and those of the reference systems.
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
  if (!arguments.join.empty()) return run_join(arguments);
  if (arguments.files.empty()) throw UsageError("prepare needs a FILE, or parts to --join");
  LoadOptions how;
  how.generalization.weights = word_or_throw("--weights", arguments.weights, kWeightNames);
  apply(arguments.coverage, how.generalization);
  how.selection = arguments.selection;
  std::optional<PartRange> parts;
  if (!arguments.part.empty()) parts = parts_or_throw(arguments.part);
  const std::vector<LayerConfig> layers = layers_or_throw(arguments.files);
  const std::vector<std::string> grids = grids_or_throw(arguments.crs);
  if (parts && grids.size() > 1) {
    throw UsageError("--part and --crs exclude each other: layers in parts are in EPSG:3857");
  }
  make_folder(arguments.output);
  bool is_all_prepared = true;
  for (const LayerConfig& layer : layers) {
    const auto output = std::filesystem::path(arguments.output) / (layer.name + kExtension);
    for (const std::string& grid : grids) {
      how.grid = grid;
      try {
        if (parts) {
          prepare_parts(layer, how, *parts, arguments);
        } else {
          prepare(layer.file, stamp_or_throw(layer.file), how, arguments.max_skipped,
                  grid.empty() ? output.string() : prepared_on_grid(output.string(), grid),
                  arguments.reuse);
        }
      } catch (const std::exception& error) {
        // Reported here and not by main, so that the following files are prepared, too.
        fmt::print(stderr, "trapeze: {}\n", failure_words(error, layer.file));
        is_all_prepared = false;
      }
    }
  }
  return is_all_prepared ? 0 : 1;
}

}  // namespace trapeze
