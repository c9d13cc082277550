#include "core/io/prepared/prepared_layer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "core/grid/digest.h"
#include "core/io/file/byte_stream.h"
#include "core/io/file/mapped_file.h"
#include "core/io/file/prepared_file.h"
#include "core/io/load/source_division.h"
#include "core/io/prepared/build_fingerprint.h"
#include "core/io/source/target_grid.h"
#include "core/labels/label_anchors.h"
#include "core/layer/layer_arrays.h"

namespace trapeze {

template <>
inline constexpr bool kIsStorable<LabelAnchor> = sizeof(LabelAnchor) ==
                                                 sizeof(LabelAnchor::row) +
                                                     sizeof(LabelAnchor::place) +
                                                     sizeof(LabelAnchor::depth) +
                                                     sizeof(LabelAnchor::area);

namespace {

constexpr const char* kPrepareAgain = "; run `trapeze prepare` again";

/// The file is undamaged, but the layer would be built differently now.
class UnfitError : public PreparedFileError {
 public:
  using PreparedFileError::PreparedFileError;
};

/// The small parts of a file, which are not arrays.
struct Description {
  LayerArrays numbers;  // everything except the arrays
  std::uint64_t revision = 0;
  SourceStamp source;
  LoadReport report;
  std::optional<PartNumber> part;
  LevelCounts counts;  // of a part
};

// Writing and reading list the same parts in the same order; keep them side by side.

void write_stamp(const SourceStamp& stamp, ByteWriter& out) {
  out.add_text(stamp.path);
  out.add(std::uint64_t{stamp.files.size()});
  for (const FileStamp& file : stamp.files) {
    out.add_text(file.name);
    out.add(file.size);
    out.add(file.modified);
    out.add(file.checksum);
  }
}

SourceStamp read_stamp(ByteReader& in) {
  SourceStamp stamp;
  stamp.path = in.take_text();
  stamp.files.resize(in.take_count(4 * sizeof(std::uint64_t)));
  for (FileStamp& file : stamp.files) {
    file.name = in.take_text();
    file.size = in.take<std::uint64_t>();
    file.modified = in.take<std::int64_t>();
    file.checksum = in.take<std::uint64_t>();
  }
  return stamp;
}

/// Calls visit(count) for every count of a report.
template <typename Report, typename Visit>
void for_each_count(Report& report, const Visit& visit) {
  for (auto* count : {&report.features, &report.loaded, &report.other_geometry, &report.empty,
                      &report.skipped, &report.polygons, &report.rings, &report.source_vertices,
                      &report.vertices, &report.collapsed_rings, &report.repaired}) {
    visit(*count);
  }
  for (const auto count : kCoverageCounts) visit(report.coverage.*count);
}

void write_report(const LoadReport& report, ByteWriter& out) {
  out.add_text(report.driver);
  for_each_count(report, [&out](std::size_t count) { out.add(std::uint64_t{count}); });
  out.add(std::uint64_t{report.notes.size()});
  for (const FeatureNote& note : report.notes) {
    out.add(note.id);
    out.add_text(note.reason);
  }
}

LoadReport read_report(ByteReader& in) {
  LoadReport report;
  report.driver = in.take_text();
  for_each_count(report, [&in](std::size_t& count) { count = in.take<std::uint64_t>(); });
  report.notes.resize(in.take_count(2 * sizeof(std::uint64_t)));
  for (FeatureNote& note : report.notes) {
    note.id = in.take<std::int64_t>();
    note.reason = in.take_text();
  }
  return report;
}

void write_fields(const std::vector<Field>& fields, ByteWriter& out) {
  out.add(std::uint64_t{fields.size()});
  for (const Field& field : fields) {
    out.add_text(field.name);
    out.add(static_cast<std::uint8_t>(field.type));
  }
}

// In the byte of the coverage mode: there are blocks, and their distance follows.
constexpr std::uint8_t kBlocksBit = 0x80;
// The blocks are restricted to classes, and the attribute follows.
constexpr std::uint8_t kClassesBit = 0x40;
// There are overlaps that were not found.
constexpr std::uint8_t kMoreOverlapsBit = 0x20;
constexpr std::uint8_t kCoverageBits = kBlocksBit | kClassesBit | kMoreOverlapsBit;

/// A value of an enumeration whose last value is `last`.
template <typename Enum>
Enum enum_of(std::uint8_t number, Enum last) {
  if (number > static_cast<std::uint8_t>(last)) {
    throw std::invalid_argument("the description holds an unknown word");
  }
  return static_cast<Enum>(number);
}

template <typename Enum>
Enum take_enum(ByteReader& in, Enum last) {
  return enum_of(in.take<std::uint8_t>(), last);
}

std::vector<Field> read_fields(ByteReader& in) {
  std::vector<Field> fields(in.take_count(sizeof(std::uint64_t) + 1));
  for (Field& field : fields) {
    field.name = in.take_text();
    field.type = take_enum(in, FieldType::text);
  }
  return fields;
}

void write_numbers(const LayerArrays& numbers, ByteWriter& out) {
  out.add(static_cast<std::uint8_t>(numbers.options.weights));
  out.add(static_cast<std::uint8_t>(numbers.options.topology));
  const bool has_blocks = numbers.options.merge > 0;
  const bool has_classes = !numbers.options.merge_by.empty();
  out.add(static_cast<std::uint8_t>(
      static_cast<std::uint8_t>(numbers.options.coverage) | (has_blocks ? kBlocksBit : 0) |
      (has_classes ? kClassesBit : 0) | (numbers.has_all_overlaps ? 0 : kMoreOverlapsBit)));
  out.add(std::bit_cast<std::uint64_t>(numbers.options.close_gaps));
  if (has_blocks) out.add(std::bit_cast<std::uint64_t>(numbers.options.merge));
  if (has_classes) out.add_text(numbers.options.merge_by);
  const Box& box = numbers.bounds;
  for (const std::int32_t side : {box.min_x, box.min_y, box.max_x, box.max_y}) out.add(side);
  const LayerSize& size = numbers.size;
  for (const std::uint64_t sum : {size.vertices, size.trapezoids, size.edges, size.motes}) {
    out.add(sum);
  }
  out.add(numbers.horizontal_edges);
  out.add(numbers.single_motes);
  write_fields(numbers.fields, out);
}

LayerArrays read_numbers(ByteReader& in) {
  LayerArrays numbers;
  numbers.options.weights = take_enum(in, WeightRule::shape);
  numbers.options.topology = take_enum(in, Topology::fast);
  const auto coverage = in.take<std::uint8_t>();
  const bool has_blocks = (coverage & kBlocksBit) != 0;
  numbers.options.coverage =
      enum_of(static_cast<std::uint8_t>(coverage & ~kCoverageBits), CoverageMode::on);
  numbers.has_all_overlaps = (coverage & kMoreOverlapsBit) == 0;
  numbers.options.close_gaps = std::bit_cast<double>(in.take<std::uint64_t>());
  if (has_blocks) numbers.options.merge = std::bit_cast<double>(in.take<std::uint64_t>());
  if ((coverage & kClassesBit) != 0) numbers.options.merge_by = in.take_text();
  Box& box = numbers.bounds;
  for (auto* side : {&box.min_x, &box.min_y, &box.max_x, &box.max_y}) {
    *side = in.take<std::int32_t>();
  }
  LayerSize& size = numbers.size;
  for (auto* sum : {&size.vertices, &size.trapezoids, &size.edges, &size.motes}) {
    *sum = in.take<std::uint64_t>();
  }
  numbers.horizontal_edges = in.take<std::uint64_t>();
  numbers.single_motes = in.take<std::uint64_t>();
  numbers.fields = read_fields(in);
  return numbers;
}

/// Calls visit(number) for every count of a part.
template <typename Counts, typename Visit>
void for_each_count_by_level(Counts& counts, const Visit& visit) {
  for (auto* of_level :
       {&counts.trapezoids, &counts.horizontal_edges, &counts.motes, &counts.grains}) {
    for (auto& count : *of_level) visit(count);
  }
  visit(counts.overlaps);
  visit(counts.overlaps_along);
}

void write_part(const LoadedLayer& loaded, ByteWriter& out) {
  out.add(static_cast<std::uint8_t>(loaded.part.has_value()));
  if (!loaded.part) return;
  out.add(loaded.part->number);
  out.add(loaded.part->count);
  out.add(loaded.part->division);
  out.add(loaded.part->revision_of_parts);
  out.add(loaded.part->first_level);
  const LevelCounts counts = count_by_level(*loaded.layer);
  for_each_count_by_level(counts, [&out](std::uint64_t count) { out.add(count); });
}

void read_part(ByteReader& in, Description& description) {
  if (in.take<std::uint8_t>() == 0) return;
  PartNumber part;
  part.number = in.take<std::uint32_t>();
  part.count = in.take<std::uint32_t>();
  part.division = in.take<std::uint64_t>();
  part.revision_of_parts = in.take<std::uint64_t>();
  part.first_level = in.take<Level>();
  if (part.number > part.count || part.count == 0 || part.count > kMostParts ||
      part.first_level > kLastLevel) {
    throw std::invalid_argument("the description names a part that there cannot be");
  }
  description.part = part;
  for_each_count_by_level(description.counts,
                          [&in](std::uint64_t& count) { count = in.take<std::uint64_t>(); });
}

ByteWriter written(const LayerArrays& numbers, std::uint64_t revision, const SourceStamp& source,
                   const LoadedLayer& loaded) {
  ByteWriter out;
  write_numbers(numbers, out);
  out.add(revision);
  write_stamp(source, out);
  write_report(loaded.report, out);
  write_part(loaded, out);
  return out;
}

Description read_description(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  Description description;
  description.numbers = read_numbers(in);
  description.revision = in.take<std::uint64_t>();
  description.source = read_stamp(in);
  description.report = read_report(in);
  read_part(in, description);
  if (!in.is_at_end()) throw std::invalid_argument("the description is too long");
  return description;
}

void add_arrays(const LayerArrays& a, SectionWriter& out) {
  out.add(SectionKind::vertices, a.vertices);
  out.add(SectionKind::edges, a.edges);
  out.add(SectionKind::trapezoids, a.trapezoids);
  out.add(SectionKind::lifespans, a.lifespans);
  out.add(SectionKind::feature_of, a.feature_of);
  out.add(SectionKind::polygon_index, a.polygon_index);
  out.add(SectionKind::level_edge_index, a.horizontal_edge_index);
  out.add(SectionKind::mote_index, a.mote_index);
  out.add(SectionKind::merged_mote_index, a.merged_mote_index);
  out.add(SectionKind::grains, a.grains);
  out.add(SectionKind::overlaps, a.overlaps);
  out.add(SectionKind::outline_points, a.outline_points);
  out.add(SectionKind::ring_ends, a.ring_ends);
  out.add(SectionKind::outline_ends, a.outline_ends);
  out.add(SectionKind::loop_sizes, a.outline.loop_sizes);
  out.add(SectionKind::milestone_ends, a.outline.milestone_ends);
  out.add(SectionKind::milestones, a.outline.milestones);
  out.add(SectionKind::milestone_levels, a.outline.milestone_levels);
  out.add(SectionKind::feature_units, a.units.features);
  out.add(SectionKind::group_units, a.units.groups);
  out.add(SectionKind::group_members, a.units.members);
  out.add(SectionKind::group_overlaps, a.units.overlaps);
  out.add(SectionKind::ids, a.cells.ids);
  out.add(SectionKind::string_bytes, a.cells.string_bytes);
  out.add(SectionKind::string_ends, a.cells.string_ends);
  for (const FeatureTable::Cells::Column& column : a.cells.columns) {
    out.add(SectionKind::numbers, column.numbers);
    out.add(SectionKind::nulls, column.nulls);
    out.add(SectionKind::texts, column.texts);
  }
}

/// Empty for a part of a layer, because labels are placed for the whole layer.
LabelAnchors label_anchors_of(const LoadedLayer& loaded, const EarlierPrepared& earlier) {
  if (loaded.part) return {std::span<const LabelAnchor>(), LabelParts::all};
  const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  return {*loaded.layer, {earlier.layer.get(), earlier.label_anchors}, threads};
}

std::span<const LabelAnchor> take_label_anchors(SectionReader& in, std::size_t features) {
  const auto anchors = in.take<LabelAnchor>(SectionKind::label_anchors);
  std::uint32_t row = 0;
  for (const LabelAnchor& anchor : anchors) {
    const bool is_sound = anchor.row >= row && anchor.row < features &&
                          anchor.place.x >= kGridMin && anchor.place.x <= kGridMax &&
                          anchor.place.y >= kGridMin && anchor.place.y <= kGridMax &&
                          std::isfinite(anchor.depth) && anchor.depth > 0 &&
                          std::isfinite(anchor.area) && anchor.area >= 0;
    if (!is_sound) throw std::invalid_argument("a label has no place");
    row = anchor.row;
  }
  return anchors;
}

void take_arrays(SectionReader& in, LayerArrays& a) {
  a.vertices = in.take<Point>(SectionKind::vertices);
  a.edges = in.take<MeshEdge>(SectionKind::edges);
  a.trapezoids = in.take<MeshTrapezoid>(SectionKind::trapezoids);
  a.lifespans = in.take<Lifespan>(SectionKind::lifespans);
  a.feature_of = in.take<std::uint32_t>(SectionKind::feature_of);
  a.polygon_index = in.take<MeshIndex::Entry>(SectionKind::polygon_index);
  a.horizontal_edge_index = in.take<MeshIndex::Entry>(SectionKind::level_edge_index);
  a.mote_index = in.take<MeshIndex::Entry>(SectionKind::mote_index);
  a.merged_mote_index = in.take<MeshIndex::Entry>(SectionKind::merged_mote_index);
  a.grains = in.take<FeatureGrain>(SectionKind::grains);
  a.overlaps = in.take<FeatureOverlap>(SectionKind::overlaps);
  a.outline_points = in.take<Point>(SectionKind::outline_points);
  a.ring_ends = in.take<std::uint32_t>(SectionKind::ring_ends);
  a.outline_ends = in.take<std::uint32_t>(SectionKind::outline_ends);
  a.outline.loop_sizes = in.take<LoopSize>(SectionKind::loop_sizes);
  a.outline.milestone_ends = in.take<std::uint32_t>(SectionKind::milestone_ends);
  a.outline.milestones = in.take<Milestone>(SectionKind::milestones);
  a.outline.milestone_levels = in.take<Level>(SectionKind::milestone_levels);
  a.units.features = in.take<FeatureUnit>(SectionKind::feature_units);
  a.units.groups = in.take<GroupUnit>(SectionKind::group_units);
  a.units.members = in.take<GroupMember>(SectionKind::group_members);
  a.units.overlaps = in.take<GroupOverlap>(SectionKind::group_overlaps);
  a.cells.ids = in.take<std::int64_t>(SectionKind::ids);
  a.cells.string_bytes = in.take<char>(SectionKind::string_bytes);
  a.cells.string_ends = in.take<std::uint64_t>(SectionKind::string_ends);
  for (std::size_t i = 0; i < a.fields.size(); ++i) {
    auto& column = a.cells.columns.emplace_back();
    column.numbers = in.take<std::uint64_t>(SectionKind::numbers);
    column.nulls = in.take<std::uint64_t>(SectionKind::nulls);
    column.texts = in.take<std::uint32_t>(SectionKind::texts);
  }
}

std::string text_of(double number) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

void check_options(const LayerOptions& options, const PreparedDemands& demands) {
  if (demands.weights && *demands.weights != options.weights) {
    throw UnfitError("was prepared with the weights " +
                     std::string(kWeightNames.name_of(options.weights)) + ", and " +
                     std::string(kWeightNames.name_of(*demands.weights)) + " are configured");
  }
  if (demands.coverage && *demands.coverage != options.coverage) {
    throw UnfitError("was prepared with coverage " +
                     std::string(kCoverageNames.name_of(options.coverage)) + ", and " +
                     std::string(kCoverageNames.name_of(*demands.coverage)) + " is configured");
  }
  if (demands.close_gaps && *demands.close_gaps != options.close_gaps) {
    throw UnfitError("was prepared with gaps closed up to " + text_of(options.close_gaps) +
                     " m, and " + text_of(*demands.close_gaps) + " m are configured");
  }
  if (demands.merge && *demands.merge != options.merge) {
    throw UnfitError("was prepared with blocks of polygons up to " + text_of(options.merge) +
                     " pixels apart, and " + text_of(*demands.merge) + " are configured");
  }
  if (demands.merge_by && *demands.merge_by != options.merge_by) {
    const auto words = [](const std::string& name) {
      return name.empty() ? std::string("no attribute") : "\"" + name + "\"";
    };
    throw UnfitError("was prepared with blocks by " + words(options.merge_by) + ", and " +
                     words(*demands.merge_by) + " is configured");
  }
}

/// Fingerprint of how layers are built, and on which grid.
std::uint64_t fingerprint_on(const std::string& grid, const LayerOptions& options) {
  const std::uint64_t fingerprint = build_fingerprint(options);
  if (grid.empty()) return fingerprint;
  const auto where = find_target_grid(grid);
  Digester digester;
  digester.add(fingerprint);
  for (const char c : where->name) digester.add(static_cast<std::uint64_t>(c));
  for (const double side : {where->middle_x, where->middle_y, where->half_side}) {
    digester.add(std::bit_cast<std::uint64_t>(side));
  }
  return digester.digest().low;
}

void check_fingerprint(const LayerOptions& options, const std::string& grid,
                       std::uint64_t fingerprint) {
  if (fingerprint_on(grid, options) == fingerprint) return;
  throw UnfitError(
      "was prepared by a version of Trapeze that builds layers differently, or not for " +
      (grid.empty() ? "EPSG:3857" : grid));
}

void check_source(const SourceStamp& stamp, const PreparedDemands& demands) {
  const std::string change =
      change_since(stamp, demands.source.empty() ? stamp.path : demands.source);
  if (change.empty()) return;
  throw PreparedFileError("is older than its source: " + change);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

LoadedLayer layer_from_sections(SectionReader& sections, Description description,
                                std::shared_ptr<const void> memory) {
  take_arrays(sections, description.numbers);
  LoadedLayer loaded;
  loaded.label_anchors = take_label_anchors(sections, description.numbers.cells.ids.size());
  sections.finish();
  loaded.layer = layer_from(description.numbers, std::move(memory));
  loaded.report = std::move(description.report);
  loaded.report.prepared_from = std::move(description.source.path);
  loaded.revision = description.revision;
  loaded.part = description.part;
  return loaded;
}

Description take_description(SectionReader& sections) {
  return read_description(sections.take<std::byte>(SectionKind::description));
}

PreparedSummary summary_of(Description&& description, const SectionReader& sections,
                           std::size_t file_size) {
  PreparedSummary summary;
  summary.fields = std::move(description.numbers.fields);
  summary.bounds = description.numbers.bounds;
  summary.size = description.numbers.size;
  summary.options = description.numbers.options;
  summary.report = std::move(description.report);
  summary.report.prepared_from = description.source.path;
  summary.revision = description.revision;
  summary.source = std::move(description.source);
  summary.part = description.part;
  summary.counts = description.counts;
  summary.fingerprint = sections.fingerprint();
  summary.file_size = file_size;
  return summary;
}

/// Calls open() and converts its exceptions to messages for the operator of the server.
template <typename Open>
auto opened(const std::string& path, const Open& open) {
  try {
    return open();
  } catch (const PreparedFileError& error) {
    throw std::runtime_error(path + ": " + error.what() + kPrepareAgain);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": is damaged: " + error.what() + kPrepareAgain);
  }
}

LoadedLayer open(const std::string& path, const PreparedDemands& demands) {
  const auto start = std::chrono::steady_clock::now();
  const auto file = std::make_shared<const MappedFile>(path);
  SectionReader sections(file->bytes());
  Description description = take_description(sections);
  const double read_seconds = seconds_since(start);
  check_fingerprint(description.numbers.options, demands.grid, sections.fingerprint());
  check_options(description.numbers.options, demands);
  check_source(description.source, demands);
  LoadedLayer loaded = layer_from_sections(sections, std::move(description), file);
  loaded.file = file;
  loaded.report.path = path;
  loaded.report.read_seconds = read_seconds;
  loaded.report.total_seconds = seconds_since(start);
  return loaded;
}

}  // namespace

void save_prepared_layer(const std::string& path, const LoadedLayer& loaded, std::uint64_t revision,
                         const SourceStamp& source, const std::string& grid,
                         const EarlierPrepared& earlier) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !is_prepared_file(path)) {
    throw std::runtime_error(path + ": exists and is not a prepared file; not replaced");
  }
  const LayerArrays arrays = arrays_of(*loaded.layer);
  const ByteWriter description = written(arrays, revision, source, loaded);
  const LabelAnchors anchors = label_anchors_of(loaded, earlier);
  if (earlier.file != nullptr && !earlier.file->is_whole()) {
    throw std::runtime_error(earlier.path + ": was modified while it was read");
  }
  SectionWriter sections;
  sections.add(SectionKind::description, std::span(description.bytes()));
  add_arrays(arrays, sections);
  sections.add(SectionKind::label_anchors, anchors.all());
  sections.write(path, fingerprint_on(grid, arrays.options));
}

LoadedLayer open_prepared_layer(const std::string& path, const PreparedDemands& demands) {
  return opened(path, [&] { return open(path, demands); });
}

PreparedSummary read_prepared_summary(const std::string& path) {
  return opened(path, [&path] {
    const MappedFile file(path, MappedFile::Pages::as_needed);
    SectionReader sections(file.bytes(), SectionReader::Checked::first);
    return summary_of(take_description(sections), sections, file.bytes().size());
  });
}

void check_prepared_summary(const std::string& path, const PreparedSummary& summary,
                            const PreparedDemands& demands) {
  opened(path, [&] {
    check_fingerprint(summary.options, demands.grid, summary.fingerprint);
    check_options(summary.options, demands);
    check_source(summary.source, demands);
  });
}

LoadedLayer open_summarized_layer(const std::string& path, const PreparedSummary& summary) {
  return opened(path, [&] {
    const auto file = std::make_shared<const MappedFile>(path);
    SectionReader sections(file->bytes());
    Description description = take_description(sections);
    if (description.revision != summary.revision || description.part != summary.part ||
        sections.fingerprint() != summary.fingerprint) {
      throw PreparedFileError("has been replaced since the layers were read");
    }
    LoadedLayer loaded = layer_from_sections(sections, std::move(description), file);
    loaded.file = file;
    loaded.report.path = path;
    file->release_pages();
    return loaded;
  });
}

EarlierPrepared open_earlier_layer(const std::string& path, const LayerOptions& options,
                                   const std::string& grid) {
  EarlierPrepared earlier;
  earlier.path = path;
  try {
    const auto file = std::make_shared<const MappedFile>(path);
    SectionReader sections(file->bytes());
    Description description = take_description(sections);
    check_options(description.numbers.options,
                  {options.weights, "", options.coverage, options.close_gaps, "", options.merge,
                   options.merge_by});
    check_fingerprint(options, grid, sections.fingerprint());
    LoadedLayer loaded = layer_from_sections(sections, std::move(description), file);
    earlier.layer = std::move(loaded.layer);
    earlier.label_anchors = loaded.label_anchors;
    earlier.file = file;
  } catch (const UnfitError& error) {
    earlier.unfit = error.what();
  } catch (const OtherFormatError& error) {
    earlier.unfit = error.what();
  } catch (const PreparedFileError& error) {
    throw std::runtime_error(path + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": is damaged: " + error.what());
  }
  return earlier;
}

LoadedLayer layer_of_prepared_bytes(std::span<const std::byte> bytes,
                                    std::shared_ptr<const void> memory) {
  SectionReader sections(bytes);
  Description description = take_description(sections);
  return layer_from_sections(sections, std::move(description), std::move(memory));
}

}  // namespace trapeze
