#include "core/io/prepared/prepared_layer.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/file/checksum.h"
#include "core/io/file/mapped_file.h"
#include "core/io/file/prepared_file.h"
#include "core/io/prepared/open_layer.h"
#include "core/io/source/open_source.h"
#include "core/layer/layer_arrays.h"
#include "core/layer/layer_builder.h"
#include "core/layer/untested_layer.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr std::uint64_t kRevision = 0x123456789abcdef0;
const std::string kMixed = TRAPEZE_FIXTURES "/mixed.geojson";

LoadedLayer prepare(const std::string& source, const std::string& path,
                    const LoadOptions& options = {}) {
  LoadedLayer loaded = load_layer(source, options);
  save_prepared_layer(path, loaded, kRevision, stamp_source(source));
  return loaded;
}

std::string failure_of(const std::string& path, const PreparedDemands& demands = {}) {
  try {
    open_prepared_layer(path, demands);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "was opened";
}

/// Bytes aligned as in a mapped file: at the border of a page, or of a cache line.
class AlignedBytes {
 public:
  explicit AlignedBytes(const std::string& bytes)
      : size_(bytes.size()), memory_(new (std::align_val_t{kSectionAlignment}) char[bytes.size()]) {
    std::memcpy(memory_, bytes.data(), bytes.size());
  }
  ~AlignedBytes() { ::operator delete[](memory_, std::align_val_t{kSectionAlignment}); }
  AlignedBytes(const AlignedBytes&) = delete;
  AlignedBytes& operator=(const AlignedBytes&) = delete;

  std::span<const std::byte> first(std::size_t size) const {
    return std::as_bytes(std::span<const char>(memory_, size));
  }
  std::span<const std::byte> all() const { return first(size_); }
  char& operator[](std::size_t i) { return memory_[i]; }

 private:
  std::size_t size_;
  char* memory_;
};

bool is_taken(std::span<const std::byte> bytes) {
  try {
    layer_of_prepared_bytes(bytes, nullptr);
  } catch (const PreparedFileError&) {
    return false;
  }
  return true;
}

/// Where the directory and the sections of a file begin and end, in ascending order.
std::vector<std::size_t> borders_of(const std::string& bytes) {
  PreparedHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  std::vector<std::size_t> borders = {0, sizeof header};
  const auto add = [&borders](std::size_t size) {
    borders.push_back(borders.back() + size);
    borders.push_back((borders.back() + kSectionAlignment - 1) / kSectionAlignment *
                      kSectionAlignment);
  };
  add(header.section_count * sizeof(DirectoryEntry));
  for (std::size_t i = 0; i < header.section_count; ++i) {
    DirectoryEntry entry;
    std::memcpy(&entry, bytes.data() + sizeof header + i * sizeof entry, sizeof entry);
    add(entry.count * entry.item_size);
  }
  return borders;
}

/// Changes the header of a file, and updates its checksum.
template <typename Change>
void change_header(const std::string& path, const Change& change) {
  std::string bytes = read_file(path);
  PreparedHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  change(header);
  header.header_checksum = checksum(std::as_bytes(std::span(&header, 1)).first(sizeof header - 8));
  std::memcpy(bytes.data(), &header, sizeof header);
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary) << bytes;
}

template <typename T>
void expect_equal(std::span<const T> a, std::span<const T> b) {
  EXPECT_EQ(checksum_of(a), checksum_of(b));
  EXPECT_EQ(a.size(), b.size());
}

void expect_equal_layers(const Layer& a_layer, const Layer& b_layer) {
  const LayerArrays a = arrays_of(a_layer);
  const LayerArrays b = arrays_of(b_layer);
  expect_equal(a.vertices, b.vertices);
  expect_equal(a.edges, b.edges);
  expect_equal(a.trapezoids, b.trapezoids);
  expect_equal(a.lifespans, b.lifespans);
  expect_equal(a.feature_of, b.feature_of);
  expect_equal(a.polygon_index, b.polygon_index);
  expect_equal(a.mote_index, b.mote_index);
  expect_equal(a.merged_mote_index, b.merged_mote_index);
  expect_equal(a.overlaps, b.overlaps);
  expect_equal(a.outline_points, b.outline_points);
  expect_equal(a.ring_ends, b.ring_ends);
  expect_equal(a.outline_ends, b.outline_ends);
  expect_equal(a.outline.loop_sizes, b.outline.loop_sizes);
  expect_equal(a.outline.milestone_ends, b.outline.milestone_ends);
  expect_equal(a.outline.milestones, b.outline.milestones);
  expect_equal(a.outline.milestone_levels, b.outline.milestone_levels);
  expect_equal(a.cells.ids, b.cells.ids);
  expect_equal(a.cells.string_bytes, b.cells.string_bytes);
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t i = 0; i < a.fields.size(); ++i) {
    EXPECT_EQ(a.fields[i].name, b.fields[i].name);
    EXPECT_EQ(a.fields[i].type, b.fields[i].type);
    for (std::uint32_t row = 0; row < a_layer.features().size(); ++row) {
      EXPECT_EQ(a_layer.features().value(row, static_cast<int>(i)),
                b_layer.features().value(row, static_cast<int>(i)));
    }
  }
  EXPECT_EQ(a.bounds, b.bounds);
  EXPECT_EQ(a.single_motes, b.single_motes);
  EXPECT_EQ(a.size.vertices, b.size.vertices);
  EXPECT_EQ(a.size.edges, b.size.edges);
  EXPECT_EQ(a.options.weights, b.options.weights);
}

class PreparedLayerTest : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(path(""))) {
      found.push_back(entry.path().filename().string());
    }
    std::ranges::sort(found);
    return found;
  }
  /// A source that a test may change, as GeoJSON.
  std::string source(const std::string& name, const std::string& text) const {
    return folder_.write(name, R"({"type": "FeatureCollection", "features": [{"type": "Feature",
      "properties": {"name": ")" + text +
                                   R"("}, "geometry": {"type": "Polygon",
      "coordinates": [[[1, 1], [3, 1], [3, 3], [1, 3], [1, 1]]]}}]})");
  }

  const TemporaryFolder folder_;
  const std::string prepared_ = folder_.file("layer.trapeze");
};

TEST_F(PreparedLayerTest, OpensAsTheLayerThatWasSaved) {
  for (const WeightRule weights : {WeightRule::douglas_peucker, WeightRule::effective_area}) {
    LoadOptions options;
    options.generalization.weights = weights;
    const LoadedLayer loaded = prepare(kMixed, prepared_, options);
    const LoadedLayer opened = open_prepared_layer(prepared_);
    expect_equal_layers(*opened.layer, *loaded.layer);
    expect_equal_layers(*build_without_topology_test(*opened.layer),
                        *build_without_topology_test(*loaded.layer));
    EXPECT_EQ(opened.revision, kRevision);
  }
}

TEST_F(PreparedLayerTest, KnowsThatOverlapsAreMissing) {
  const LoadedLayer loaded = load_layer(kMixed);
  for (const bool has_all : {true, false}) {
    LayerArrays arrays = arrays_of(*loaded.layer);
    arrays.has_all_overlaps = has_all;
    LoadedLayer other = load_layer(kMixed);
    other.layer = layer_from(arrays, nullptr);
    save_prepared_layer(prepared_, other, kRevision, stamp_source(kMixed));
    EXPECT_EQ(open_prepared_layer(prepared_).layer->has_all_overlaps(), has_all);
  }
}

TEST_F(PreparedLayerTest, KnowsWhereLabelsGo) {
  const LoadedLayer loaded = prepare(kMixed, prepared_, {});
  EXPECT_TRUE(loaded.label_anchors.empty());
  const LoadedLayer opened = open_prepared_layer(prepared_);
  for (const LabelParts parts : {LabelParts::largest, LabelParts::all}) {
    const LabelAnchors found(*loaded.layer, parts);
    const LabelAnchors kept(opened.label_anchors, parts);
    EXPECT_FALSE(found.all().empty());
    EXPECT_TRUE(std::ranges::equal(found.all(), kept.all()));
  }
}

TEST_F(PreparedLayerTest, KeepsTheReport) {
  const LoadReport loaded = prepare(kMixed, prepared_).report;
  const LoadReport opened = open_prepared_layer(prepared_).report;
  EXPECT_EQ(opened.path, prepared_);
  EXPECT_EQ(opened.driver, "GeoJSON");
  EXPECT_EQ(opened.prepared_from, kMixed);
  EXPECT_EQ(opened.features, loaded.features);
  EXPECT_EQ(opened.loaded, loaded.loaded);
  EXPECT_EQ(opened.other_geometry, loaded.other_geometry);
  EXPECT_EQ(opened.empty, loaded.empty);
  EXPECT_EQ(opened.skipped, loaded.skipped);
  EXPECT_EQ(opened.polygons, loaded.polygons);
  EXPECT_EQ(opened.rings, loaded.rings);
  EXPECT_EQ(opened.source_vertices, loaded.source_vertices);
  EXPECT_EQ(opened.vertices, loaded.vertices);
  EXPECT_EQ(opened.collapsed_rings, loaded.collapsed_rings);
  EXPECT_EQ(opened.repaired, loaded.repaired);
  ASSERT_EQ(opened.notes.size(), loaded.notes.size());
  ASSERT_FALSE(loaded.notes.empty());
  for (std::size_t i = 0; i < loaded.notes.size(); ++i) {
    EXPECT_EQ(opened.notes[i].id, loaded.notes[i].id);
    EXPECT_EQ(opened.notes[i].reason, loaded.notes[i].reason);
  }
}

TEST_F(PreparedLayerTest, OfASourceWithoutPolygonsOpensToo) {
  const std::string empty =
      folder_.write("empty.geojson", R"({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "Point",
         "coordinates": [1, 2]}}]})");
  prepare(empty, prepared_);
  EXPECT_TRUE(open_prepared_layer(prepared_).layer->bounds().is_empty());
}

TEST_F(PreparedLayerTest, IsTheSameFileFromTheSameSource) {
  prepare(kMixed, prepared_);
  prepare(kMixed, path("again.trapeze"), {.threads = 1, .progress = {}});
  EXPECT_EQ(read_file(prepared_), read_file(path("again.trapeze")));
}

TEST_F(PreparedLayerTest, DrawsFromTheMappedFileItself) {
  prepare(kMixed, prepared_);
  const LoadedLayer opened = open_prepared_layer(prepared_);
  const auto address = reinterpret_cast<std::uintptr_t>(opened.layer->mesh().trapezoids.data());
  std::ifstream maps("/proc/self/maps");
  std::string line;
  bool is_found = false;
  while (std::getline(maps, line)) {
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    char dash = 0;
    std::istringstream(line) >> std::hex >> begin >> dash >> end;
    if (begin > address || address >= end) continue;
    is_found = true;
    EXPECT_THAT(line, AllOf(HasSubstr(" r--s "), HasSubstr(prepared_))) << "shared, read-only";
  }
  EXPECT_TRUE(is_found);
}

TEST_F(PreparedLayerTest, IsKnownByItsBeginningWhateverItsName) {
  prepare(kMixed, path("layer.geojson"));
  EXPECT_TRUE(is_prepared_file(path("layer.geojson")));
  EXPECT_EQ(open_layer(path("layer.geojson")).revision, kRevision);
  EXPECT_FALSE(is_prepared_file(kMixed));
  EXPECT_FALSE(open_layer(kMixed).revision.has_value());
  EXPECT_FALSE(is_prepared_file(path("")));
  EXPECT_FALSE(is_prepared_file(path("nosuch")));
  EXPECT_FALSE(is_prepared_file("/dev/zero"));
  EXPECT_FALSE(is_prepared_file(folder_.write("short", "\x89TRPZ")));
}

TEST_F(PreparedLayerTest, IsNoSourceForOtherCommands) {
  prepare(kMixed, prepared_);
  EXPECT_THAT([this] { open_source(prepared_); },
              ::testing::ThrowsMessage<std::runtime_error>(
                  AllOf(StartsWith(prepared_), HasSubstr("prepared"))));
}

TEST_F(PreparedLayerTest, CutOffAnywhereIsRefused) {
  prepare(kMixed, prepared_);
  const std::string bytes = read_file(prepared_);
  const AlignedBytes aligned(bytes);
  ASSERT_TRUE(is_taken(aligned.all()));
  const std::vector<std::size_t> borders = borders_of(bytes);
  ASSERT_EQ(borders.back(), bytes.size());
  for (const std::size_t border : borders) {
    for (const std::size_t size : {border - 1, border, border + 1}) {
      if (size < bytes.size()) {
        EXPECT_FALSE(is_taken(aligned.first(size))) << size;
      }
    }
  }
  std::filesystem::resize_file(prepared_, bytes.size() / 2);
  EXPECT_THAT(failure_of(prepared_),
              AllOf(StartsWith(prepared_),
                    HasSubstr("is damaged: it has " + std::to_string(bytes.size() / 2) + " of " +
                              std::to_string(bytes.size()) + " bytes"),
                    HasSubstr("trapeze prepare")));
}

TEST_F(PreparedLayerTest, WithMoreAtItsEndIsRefused) {
  prepare(kMixed, prepared_);
  EXPECT_FALSE(is_taken(AlignedBytes(read_file(prepared_) + "x").all()));
  EXPECT_FALSE(is_taken(AlignedBytes(read_file(prepared_) + std::string(64, '\0')).all()));
}

TEST_F(PreparedLayerTest, WithAnyBitFlippedIsRefused) {
  prepare(TRAPEZE_FIXTURES "/rings.geojson", prepared_);
  const std::string bytes = read_file(prepared_);
  AlignedBytes aligned(bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      aligned[i] = static_cast<char>(aligned[i] ^ (1 << bit));
      EXPECT_FALSE(is_taken(aligned.all())) << "byte " << i << " bit " << bit;
      aligned[i] = bytes[i];
    }
  }
  EXPECT_TRUE(is_taken(aligned.all()));
}

TEST_F(PreparedLayerTest, NamesTheDamagedSection) {
  prepare(kMixed, prepared_);
  std::string bytes = read_file(prepared_);
  const std::vector<std::size_t> borders = borders_of(bytes);
  bytes[borders[6]] ^= 1;  // after header, directory and description
  std::filesystem::remove(prepared_);
  std::ofstream(prepared_, std::ios::binary) << bytes;
  EXPECT_THAT(failure_of(prepared_), HasSubstr("is damaged: its section \"vertices\""));
}

TEST_F(PreparedLayerTest, OfAnotherVersionIsRefused) {
  prepare(kMixed, prepared_);
  change_header(prepared_, [](PreparedHeader& header) { ++header.version; });
  EXPECT_THAT(
      failure_of(prepared_),
      AllOf(StartsWith(prepared_), HasSubstr("format " + std::to_string(kPreparedVersion + 1)),
            HasSubstr("reads " + std::to_string(kPreparedVersion))));
  prepare(kMixed, path("built.trapeze"));
  change_header(path("built.trapeze"), [](PreparedHeader& header) { ++header.fingerprint; });
  EXPECT_THAT(failure_of(path("built.trapeze")), HasSubstr("builds layers differently"));
  prepare(kMixed, path("order.trapeze"));
  change_header(path("order.trapeze"), [](PreparedHeader& h) { h.byte_order = 0x04030201; });
  EXPECT_THAT(failure_of(path("order.trapeze")), HasSubstr("byte order"));
}

TEST_F(PreparedLayerTest, WithOtherWeightsThanDemandedIsRefused) {
  LoadOptions options;
  options.generalization.weights = WeightRule::raised_parents;
  prepare(kMixed, prepared_, options);
  EXPECT_THAT(failure_of(prepared_, {WeightRule::effective_area, {}}),
              AllOf(HasSubstr("raised-parents"), HasSubstr("effective-area")));
  EXPECT_NO_THROW(open_prepared_layer(prepared_, {WeightRule::raised_parents, {}}));
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
}

TEST_F(PreparedLayerTest, WithAnotherCoverageThanDemandedIsRefused) {
  LoadOptions options;
  options.generalization.coverage = CoverageMode::on;
  const std::string neighbours = folder_.write("neighbours.geojson", R"({
      "type": "FeatureCollection", "features": [
      {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon",
       "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]]}},
      {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon",
       "coordinates": [[[1, 0], [2, 0], [2, 1], [1, 1], [1, 0]]]}}]})");
  prepare(neighbours, prepared_, options);
  EXPECT_THAT(failure_of(prepared_, {{}, {}, CoverageMode::automatic}),
              AllOf(HasSubstr("coverage on"), HasSubstr("auto is configured")));
  const LoadedLayer opened = open_prepared_layer(prepared_, {{}, {}, CoverageMode::on});
  const CoverageCounts built = load_layer(neighbours, options).report.coverage;
  EXPECT_EQ(built.groups, 1u);
  EXPECT_EQ(opened.report.coverage.groups, 1u);
  EXPECT_EQ(opened.report.coverage.features, 2u);
  EXPECT_EQ(opened.report.coverage.shared_edges, 1u);
}

TEST_F(PreparedLayerTest, WithOtherGapsClosedThanDemandedIsRefused) {
  LoadOptions options;
  options.generalization.coverage = CoverageMode::automatic;
  options.generalization.close_gaps = 2.5;
  prepare(kMixed, prepared_, options);
  PreparedDemands demands;
  demands.close_gaps = 0;
  EXPECT_THAT(failure_of(prepared_, demands),
              AllOf(HasSubstr("gaps closed up to 2.5 m"), HasSubstr("0 m are configured")));
  demands.close_gaps = 2.5;
  EXPECT_NO_THROW(open_prepared_layer(prepared_, demands));
}

TEST_F(PreparedLayerTest, WithOtherBlocksThanDemandedIsRefused) {
  LoadOptions options;
  options.generalization.merge = 2.5;
  prepare(kMixed, prepared_, options);
  PreparedDemands demands;
  demands.merge = 0;
  EXPECT_THAT(
      failure_of(prepared_, demands),
      AllOf(HasSubstr("blocks of polygons up to 2.5 pixels"), HasSubstr("0 are configured")));
  demands.merge = 2.5;
  EXPECT_EQ(arrays_of(*open_prepared_layer(prepared_, demands).layer).options,
            options.generalization);
}

TEST_F(PreparedLayerTest, WithBlocksByAnotherAttributeThanDemandedIsRefused) {
  LoadOptions options;
  options.generalization.merge = 2.5;
  options.generalization.merge_by = "name";
  prepare(kMixed, prepared_, options);
  PreparedDemands demands;
  EXPECT_EQ(arrays_of(*open_prepared_layer(prepared_, demands).layer).options,
            options.generalization);
  demands.merge_by = "kind";
  EXPECT_THAT(failure_of(prepared_, demands),
              AllOf(HasSubstr("blocks by \"name\""), HasSubstr("\"kind\" is configured")));
  demands.merge_by = "name";
  EXPECT_NO_THROW(open_prepared_layer(prepared_, demands));
  LayerOptions whatever = options.generalization;
  whatever.merge_by.clear();
  EXPECT_THAT(open_earlier_layer(prepared_, whatever).unfit, HasSubstr("no attribute"));
  EXPECT_THAT(open_earlier_layer(prepared_, options.generalization).unfit, IsEmpty());
}

TEST_F(PreparedLayerTest, IsServedWithoutItsSource) {
  const std::string file = source("source.geojson", "a");
  prepare(file, prepared_);
  std::filesystem::remove(file);
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
  EXPECT_NO_THROW(open_prepared_layer(prepared_, {{}, path("elsewhere.geojson")}));
}

TEST_F(PreparedLayerTest, IsRefusedWhenADatabaseHasChangesThatAreNotInTheFileYet) {
  const std::string file = path("town.gpkg");
  write_source(file, "GPKG", {{.features = {{"POLYGON((0 0,1 0,1 1,0 0))", 1, "a"}}}});
  prepare(file, prepared_);
  std::ofstream(file + "-wal").flush();
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
  std::ofstream(file + "-wal") << "changes";
  EXPECT_THAT(failure_of(prepared_), HasSubstr(file + "-wal is new"));
}

TEST_F(PreparedLayerTest, IsRefusedWhenItsSourceHasChanged) {
  const std::string file = source("source.geojson", "aa");
  prepare(file, prepared_);
  source("source.geojson", "aaa");
  EXPECT_THAT(failure_of(prepared_), AllOf(HasSubstr("older than its source"), HasSubstr(file),
                                           HasSubstr("bytes"), HasSubstr("trapeze prepare")));
  source("source.geojson", "bb");
  std::filesystem::last_write_time(
      file, std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  EXPECT_THAT(failure_of(prepared_), HasSubstr(file + " has other contents"));
}

TEST_F(PreparedLayerTest, DoesNotMindACopyOfItsSourceWithAnotherTime) {
  const std::string file = source("source.geojson", "a");
  prepare(file, prepared_);
  std::filesystem::last_write_time(
      file, std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5));
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
}

TEST_F(PreparedLayerTest, IsComparedWithTheSourceThatIsNamed) {
  const std::string file = source("source.geojson", "a");
  prepare(file, prepared_);
  EXPECT_NO_THROW(open_prepared_layer(prepared_, {{}, source("same.geojson", "a")}));
  EXPECT_THAT(failure_of(prepared_, {{}, source("other.geojson", "bcd")}),
              HasSubstr("other.geojson has"));
}

TEST_F(PreparedLayerTest, NoticesChangesInEveryFileOfAShapefile) {
  const auto write = [](const std::string& shapes, const std::string& text) {
    write_source(shapes, "ESRI Shapefile",
                 {{.features = {{"POLYGON ((0 0, 2 0, 2 2, 0 2, 0 0))", 1, text}}}});
  };
  const std::string shapes = path("land.shp");
  write(shapes, "before");
  prepare(shapes, prepared_);
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
  std::filesystem::create_directory(path("other"));
  write(path("other") + "/land.shp", "later");
  std::filesystem::copy_file(path("other") + "/land.dbf", path("land.dbf"),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(failure_of(prepared_), HasSubstr("land.dbf"));
}

TEST_F(PreparedLayerTest, NoticesWhatAShapefileGetsBesideIt) {
  const std::string shapes = path("land.shp");
  write_source(shapes, "ESRI Shapefile",
               {{.features = {{"POLYGON ((0 0, 2 0, 2 2, 0 2, 0 0))", 1, "a"}}}});
  std::filesystem::rename(path("land.prj"), path("kept"));
  prepare(shapes, prepared_);
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
  std::filesystem::rename(path("kept"), path("land.prj"));
  EXPECT_THAT(failure_of(prepared_), HasSubstr(path("land.prj") + " is new"));
  folder_.write("land.prj", "GDAL does not list this");
  prepare(shapes, prepared_);
  EXPECT_NO_THROW(open_prepared_layer(prepared_));
  folder_.write("land.prj", "nor this");
  EXPECT_THAT(failure_of(prepared_), HasSubstr("land.prj has 8 bytes"));
}

TEST_F(PreparedLayerTest, StampsAGeoJsonWithFeaturesOfAnySize) {
  const std::string file = source("source.geojson", std::string(2000, 'a'));
  CPLSetConfigOption("OGR_GEOJSON_MAX_OBJ_SIZE", "0.001");  // megabytes
  EXPECT_NO_THROW(prepare(file, prepared_));
  CPLSetConfigOption("OGR_GEOJSON_MAX_OBJ_SIZE", nullptr);
}

TEST_F(PreparedLayerTest, ReplacesAPreparedFileWhoseOldContentsStayWhereTheyAreMapped) {
  const std::string file = source("source.geojson", "before");
  prepare(file, prepared_);
  const LoadedLayer old = open_prepared_layer(prepared_);
  source("source.geojson", "after");
  prepare(file, prepared_);
  EXPECT_EQ(old.layer->features().value(0, 0), Value(std::string_view("before")));
  EXPECT_EQ(open_prepared_layer(prepared_).layer->features().value(0, 0),
            Value(std::string_view("after")));
}

TEST_F(PreparedLayerTest, NeverReplacesAFileOfAnotherKind) {
  const std::string precious = folder_.write("precious.trapeze", "my thesis");
  EXPECT_THROW(prepare(kMixed, precious), std::runtime_error);
  EXPECT_EQ(read_file(precious), "my thesis");
}

TEST_F(PreparedLayerTest, ThatCannotBeWrittenLeavesNothingBehind) {
  const LoadedLayer loaded = load_layer(kMixed);
  const SourceStamp stamp = stamp_source(kMixed);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string words;
  try {
    save_prepared_layer(prepared_, loaded, kRevision, stamp);
  } catch (const std::runtime_error& error) {
    words = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  EXPECT_EQ(words, "cannot write " + prepared_ + ": File too large");
  EXPECT_THAT(names(), IsEmpty());
  EXPECT_THAT([&] { save_prepared_layer(path("nosuch/a"), loaded, 0, stamp); },
              ::testing::ThrowsMessage<std::runtime_error>("cannot write " + path("nosuch/a") +
                                                           ": No such file or directory"));
}

TEST_F(PreparedLayerTest, WrittenIntoWhileItIsMappedItIsNotWhole) {
  prepare(kMixed, prepared_);
  std::filesystem::permissions(prepared_, std::filesystem::perms::owner_all);
  std::string bytes(std::filesystem::file_size(prepared_), '\0');
  std::ifstream(prepared_, std::ios::binary)
      .read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const auto before = std::filesystem::last_write_time(prepared_) - std::chrono::seconds(1);
  std::filesystem::last_write_time(prepared_, before);
  for (const std::string& written : {bytes, std::string(bytes.size(), '\0'), bytes + "more"}) {
    std::ofstream(prepared_, std::ios::binary) << bytes;
    std::filesystem::last_write_time(prepared_, before);
    const LoadedLayer opened = open_prepared_layer(prepared_);
    ASSERT_TRUE(opened.file->is_whole());
    std::ofstream(prepared_, std::ios::binary) << written;
    EXPECT_FALSE(opened.file->is_whole()) << written.size();
  }
}

TEST_F(PreparedLayerTest, CutOffWhileItIsMappedReadsAsZerosAndIsNotWhole) {
  prepare(kMixed, prepared_);
  const std::uintmax_t size = std::filesystem::file_size(prepared_);
  for (const std::uintmax_t left : {std::uintmax_t{0}, size / 3, size - 1}) {
    std::filesystem::remove(prepared_);
    prepare(kMixed, prepared_);
    const LoadedLayer opened = open_prepared_layer(prepared_);
    ASSERT_TRUE(opened.file->is_whole());
    std::filesystem::permissions(prepared_, std::filesystem::perms::owner_all);
    std::filesystem::resize_file(prepared_, left);
    EXPECT_FALSE(opened.file->is_whole());

    // Whatever the content, no read goes beyond the bytes.
    const Layer& layer = *opened.layer;
    std::vector<TrapezoidRange> ranges;
    layer.select({.box = {kGridMin, kGridMin, kGridMax, kGridMax}}, ranges);
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      box_of(layer.mesh(), layer.mesh().trapezoids[i]);
      EXPECT_LT(layer.feature_of(i), layer.features().size());
    });
    Rings outline;
    for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
      layer.append_outline(row, outline);
      for (std::size_t field = 0; field < layer.features().fields().size(); ++field) {
        layer.features().value(row, static_cast<int>(field));
      }
    }
  }
}

TEST_F(PreparedLayerTest, OneThatWasReadWhileItWasCutOffIsNotWholeWhenItGetsItsBytesBack) {
  prepare(kMixed, prepared_);
  const std::string copy = prepared_ + ".copy";
  std::filesystem::copy_file(prepared_, copy);
  const auto written = std::filesystem::last_write_time(prepared_);
  const LoadedLayer opened = open_prepared_layer(prepared_);
  std::filesystem::permissions(prepared_, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(prepared_, 0);
  const std::span<const std::byte> bytes = opened.file->bytes();
  EXPECT_EQ(bytes.back(), std::byte{0});
  std::ifstream from(copy, std::ios::binary);
  std::ofstream(prepared_, std::ios::binary) << from.rdbuf();
  std::filesystem::last_write_time(prepared_, written);
  EXPECT_FALSE(opened.file->is_whole());
}

/// Loads a source, taking over from a prepared file.
LoadedLayer load_with(const std::string& source, const EarlierPrepared& earlier,
                      LoadOptions options = {}) {
  options.earlier = earlier.layer;
  return load_layer(source, options);
}

TEST_F(PreparedLayerTest, ThatTakesOverFromAnotherIsTheSameFile) {
  for (const CoverageMode coverage :
       {CoverageMode::off, CoverageMode::automatic, CoverageMode::on}) {
    LoadOptions options;
    options.generalization.coverage = coverage;
    const LoadedLayer loaded = prepare(kMixed, prepared_, options);
    const EarlierPrepared earlier = open_earlier_layer(prepared_, options.generalization);
    const LoadedLayer again = load_with(kMixed, earlier, options);
    EXPECT_EQ(again.report.taken_over, loaded.report.loaded);
    save_prepared_layer(path("again.trapeze"), again, kRevision, stamp_source(kMixed), {}, earlier);
    EXPECT_EQ(read_file(prepared_), read_file(path("again.trapeze")));
    // Replaces the file that is mapped.
    save_prepared_layer(prepared_, again, kRevision, stamp_source(kMixed), {}, earlier);
    EXPECT_EQ(read_file(prepared_), read_file(path("again.trapeze")));
    EXPECT_TRUE(earlier.file->is_whole());
  }
}

TEST_F(PreparedLayerTest, NothingIsTakenOverFromWhatWasBuiltOtherwise) {
  LoadOptions options;
  options.generalization.weights = WeightRule::raised_parents;
  options.generalization.close_gaps = 2;
  prepare(kMixed, prepared_, options);
  const auto unfit = [&](const auto& change) {
    LayerOptions wanted = options.generalization;
    change(wanted);
    const EarlierPrepared earlier = open_earlier_layer(prepared_, wanted);
    EXPECT_EQ(earlier.layer == nullptr, !earlier.unfit.empty());
    return earlier.unfit;
  };
  EXPECT_THAT(unfit([](LayerOptions&) {}), IsEmpty());
  EXPECT_THAT(unfit([](LayerOptions& o) { o.weights = WeightRule::effective_area; }),
              HasSubstr("weights raised-parents"));
  EXPECT_THAT(unfit([](LayerOptions& o) { o.coverage = CoverageMode::on; }),
              HasSubstr("coverage auto"));
  EXPECT_THAT(unfit([](LayerOptions& o) { o.close_gaps = 3; }), HasSubstr("gaps closed up to 2 m"));
  EXPECT_THAT(unfit([](LayerOptions& o) { o.merge = 4; }), HasSubstr("blocks"));
  change_header(prepared_, [](PreparedHeader& header) { ++header.fingerprint; });
  EXPECT_THAT(unfit([](LayerOptions&) {}), HasSubstr("builds layers differently"));
  change_header(prepared_, [](PreparedHeader& header) { ++header.version; });
  EXPECT_THAT(unfit([](LayerOptions&) {}), HasSubstr("has format"));
  // An in-memory layer that was built with other options is not used either.
  LoadOptions otherwise;
  otherwise.earlier = load_layer(kMixed, options).layer;
  EXPECT_EQ(load_layer(kMixed, otherwise).report.taken_over, 0u);
}

TEST_F(PreparedLayerTest, TakingOverFromWhatIsNoPreparedFileIsRefused) {
  const auto failure = [](const std::string& file) -> std::string {
    try {
      open_earlier_layer(file, {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "was opened";
  };
  EXPECT_THAT(failure(path("nosuch.trapeze")), HasSubstr("nosuch.trapeze"));
  EXPECT_THAT(failure(kMixed), AllOf(StartsWith(kMixed), HasSubstr("is not a prepared file")));
  prepare(kMixed, prepared_);
  std::string bytes = read_file(prepared_);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  const std::string damaged = folder_.write("damaged.trapeze", bytes);
  EXPECT_THAT(failure(damaged), AllOf(StartsWith(damaged), HasSubstr("is damaged")));
}

TEST_F(PreparedLayerTest, CutOffWhileItIsTakenOverFromNothingIsReadBeyond) {
  prepare(kMixed, prepared_);
  const std::uintmax_t size = std::filesystem::file_size(prepared_);
  for (const std::uintmax_t left : {std::uintmax_t{0}, size / 3, size / 2, size - 1}) {
    std::filesystem::remove(prepared_);
    prepare(kMixed, prepared_);
    const EarlierPrepared earlier = open_earlier_layer(prepared_, {});
    EarlierLayer noted(earlier.layer);
    std::filesystem::permissions(prepared_, std::filesystem::perms::owner_all);
    std::filesystem::resize_file(prepared_, left);
    EXPECT_FALSE(earlier.file->is_whole());
    // Fails for an earlier layer recorded after the file was cut, and for one recorded before
    // (`noted`).
    const LoadedLayer after = load_with(kMixed, earlier);
    EXPECT_THAT(
        [&] {
          save_prepared_layer(path("again.trapeze"), after, kRevision, stamp_source(kMixed), {},
                              earlier);
        },
        ThrowsMessage<std::runtime_error>(AllOf(StartsWith(prepared_), HasSubstr("modified"))));
    EXPECT_FALSE(std::filesystem::exists(path("again.trapeze")));
    std::vector<LayerBuilder> builders;
    builders.emplace_back(LayerOptions(), nullptr, &noted);
    FeatureTable table(std::vector<Field>{});
    Rings rings;
    const LoadedLayer source = load_layer(kMixed);
    for (std::uint32_t row = 0; row < source.layer->features().size(); ++row) {
      rings.clear();
      source.layer->append_outline(row, rings);
      builders.front().add(table.append(row, {}), rings);
    }
    LayerBuilder::join(builders, std::move(table));
  }
}

TEST_F(PreparedLayerTest, LeavesNothingButItself) {
  prepare(kMixed, prepared_);
  EXPECT_THAT(names(), ::testing::ElementsAre("layer.trapeze"));
  EXPECT_EQ(std::filesystem::status(prepared_).permissions() & std::filesystem::perms::owner_write,
            std::filesystem::perms::none);
}

}  // namespace
}  // namespace trapeze
