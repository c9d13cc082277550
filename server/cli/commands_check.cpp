#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>

#include "core/io/export/list_faults.h"
#include "core/io/prepared/open_layer.h"
#include "core/io/prepared/prepared_parts.h"
#include "server/base/failure_words.h"
#include "server/cli/commands.h"
#include "server/cli/option_values.h"
#include "server/data/load_progress.h"
#include "server/service/process_figures.h"

namespace trapeze {
namespace {

/// Prints the versions of trapezoids over all tolerances, and the dust of small polygons.
void print_history(const LayerSize& size, const LoadReport& report) {
  const double vertices = static_cast<double>(std::max<std::size_t>(report.vertices, 1));
  fmt::print("  trapezoids            {} versions, {:.2f} per vertex\n", size.trapezoids,
             static_cast<double>(size.trapezoids) / vertices);
  fmt::print("  dust                  {} motes, {:.2f} per vertex\n", size.motes,
             static_cast<double>(size.motes) / vertices);
}

void print_memory(const Layer& layer, const LoadReport& report) {
  const std::size_t graphs = layer.memory();
  const double per_vertex =
      report.vertices == 0 ? 0 : static_cast<double>(graphs) / static_cast<double>(report.vertices);
  fmt::print("  memory of graphs      {} bytes, {:.1f} per vertex\n", graphs, per_vertex);
  fmt::print("  memory of attributes  {} bytes\n", layer.features().memory());
}

/// Prints the polygons that share borders, if there are any.
void print_coverage(const CoverageCounts& counts) {
  if (counts.groups == 0 && counts.apart == 0) return;
  fmt::print("  coverages             {} groups with {} features\n", counts.groups,
             counts.features);
  fmt::print("    shared edges        {}\n", counts.shared_edges);
  fmt::print("    junctions           {}\n", counts.junctions);
  fmt::print("    noded               {} groups\n", counts.noded);
  fmt::print("    overlaps            {} pairs of features\n", counts.overlaps);
  fmt::print("    gaps                {}, {} others filled\n", counts.gaps, counts.filled);
  fmt::print("    snapped             {} vertices\n", counts.snapped);
  fmt::print("    apart               {} features that overlap by too much\n", counts.apart);
}

void print_notes(const std::vector<FeatureNote>& notes) {
  for (const FeatureNote& note : notes) {
    fmt::print("  feature {}: {}\n", note.id, note.reason);
  }
}

/// Prints a layer in parts, which are read one after the other.
void print_parts(const PreparedParts& parts) {
  fmt::print("  parts                 {}, {}\n", parts.parts().size(),
             parts.overview() == nullptr ? "without an overview"
                                         : "and an overview: " + parts.overview()->path());
  fmt::print("  files                 {} bytes\n", parts.file_size());
}

/// What is wrong with the files of a layer in parts; empty if nothing is.
std::string find_damage(const LoadedLayer& loaded) {
  if (loaded.parts == nullptr) return {};
  const auto look_at = [](const PreparedPart& part) -> std::string {
    try {
      open_summarized_layer(part.path(), part.summary());
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  };
  for (const auto& part : loaded.parts->parts()) {
    if (std::string problem = look_at(*part); !problem.empty()) return problem;
  }
  const auto& overview = loaded.parts->overview();
  return overview == nullptr ? std::string() : look_at(*overview);
}

void print_report(const LoadedLayer& loaded) {
  const LoadReport& report = loaded.report;
  fmt::print("{} ({})\n", report.path, report.origin());
  fmt::print("  features              {}\n", report.features);
  fmt::print("    loaded              {}\n", report.loaded);
  fmt::print("      of these repaired {}\n", report.repaired);
  fmt::print("    not polygons        {}\n", report.other_geometry);
  fmt::print("    empty               {}\n", report.empty);
  fmt::print("    skipped             {}\n", report.skipped);
  fmt::print("  polygons              {}\n", report.polygons);
  fmt::print("  rings                 {} ({} collapsed)\n", report.rings, report.collapsed_rings);
  fmt::print("  vertices              {} ({} in the source)\n", report.vertices,
             report.source_vertices);
  print_coverage(report.coverage);
  print_history(loaded.parts != nullptr ? loaded.parts->size() : loaded.layer->size(), report);
  if (loaded.parts != nullptr) {
    print_parts(*loaded.parts);
  } else {
    print_memory(*loaded.layer, report);
  }
  fmt::print("  seconds               {:.2f} ({:.2f} to read)\n", report.total_seconds,
             report.read_seconds);
  for (const std::string& warning : report.warnings) fmt::print("  warning: {}\n", warning);
  print_notes(report.notes);
}

/// False if the file cannot be read, or too many features are skipped.
bool check_file(const std::string& file, const OpenOptions& how, SkipLimit max_skipped) {
  LoadedLayer loaded;
  try {
    LoadProgress progress(file);
    OpenOptions options = how;
    options.grid = grid_in_name(file);
    options.progress = [&progress](double share) { progress.show(share); };
    loaded = open_layer(file, options);
  } catch (const std::exception& error) {
    // Reported here and not by main, so that the following files are checked, too.
    fmt::print(stderr, "trapeze: {}\n", failure_words(error, file));
    return false;
  }
  print_report(loaded);
  if (const std::string damage = find_damage(loaded); !damage.empty()) {
    fmt::print(stderr, "trapeze: {}\n", damage);
    return false;
  }
  const std::string excess = find_excess(loaded.report, max_skipped);
  if (!excess.empty()) fmt::print(stderr, "trapeze: {}\n", excess);
  return excess.empty();
}

/// False if the list cannot be written, or is not complete.
bool list_faults_of(const std::string& file, const CheckArguments& arguments) {
  FaultReport report;
  try {
    LoadProgress progress(file);
    FaultOptions options;
    options.overwrite = arguments.overwrite;
    options.progress = [&progress](double share) { progress.show(share); };
    report = list_faults(file, arguments.list, options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "trapeze: {}\n", error.what());
    return false;
  }
  fmt::print("{}: gaps {}, overlaps {} between the polygons of {}\n", arguments.list, report.gaps,
             report.overlaps, file);
  print_notes(report.notes);
  return report.unsearched == 0;
}

void check_arguments(const CheckArguments& arguments) {
  if (arguments.list.empty()) {
    if (arguments.overwrite) throw UsageError("--overwrite is for --list");
    return;
  }
  check_polygon_ending("--list", arguments.list);
  if (arguments.files.size() > 1) throw UsageError("--list takes one FILE at a time");
}

}  // namespace

int run_check(const CheckArguments& arguments) {
  check_arguments(arguments);
  OpenOptions how;
  apply(arguments.coverage, how);
  bool is_all_good = true;
  for (const std::string& file : arguments.files) {
    is_all_good &= check_file(file, how, arguments.max_skipped);
  }
  if (is_all_good && !arguments.list.empty()) {
    is_all_good = list_faults_of(arguments.files.front(), arguments);
  } else if (!arguments.list.empty()) {
    fmt::print(stderr, "trapeze: {}: not written\n", arguments.list);
  }
  fmt::print("memory of the process   {} bytes at most\n", process_figures().peak_resident_bytes);
  return is_all_good ? 0 : 1;
}

}  // namespace trapeze
