// Loads hostile input like any other source, and draws the result.
#include "tests/hostile/hostile_polygons.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/load/load_layer.h"
#include "render/software/software_renderer.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {

void PrintTo(const HostileInput& input, std::ostream* out) {
  *out << input.name;
}

namespace {

using ::testing::StartsWith;

// The memory that a layer may use, however faulty its source is; a little dust is kept in full.
constexpr std::size_t kMostBytesAVertex = 1000;
constexpr std::size_t kMostBytesBeside = std::size_t{16} << 20;

OGRPolygon geometry_of(const LonLatPolygon& rings) {
  OGRPolygon polygon;
  for (const LonLatRing& ring : rings) {
    OGRLinearRing line;
    line.setNumPoints(static_cast<int>(ring.size()));
    for (std::size_t i = 0; i < ring.size(); ++i) {
      line.setPoint(static_cast<int>(i), ring[i].lon, ring[i].lat);
    }
    if (!ring.empty()) line.addPoint(ring[0].lon, ring[0].lat);
    polygon.addRing(&line);
  }
  return polygon;
}

std::unique_ptr<OGRGeometry> geometry_of(const HostileFeature& feature) {
  if (!feature.wkt.empty()) return test_geometry(feature.wkt);
  if (feature.parts.empty()) return nullptr;
  if (feature.parts.size() == 1) {
    return std::make_unique<OGRPolygon>(geometry_of(feature.parts.front()));
  }
  auto parts = std::make_unique<OGRMultiPolygon>();
  for (const LonLatPolygon& part : feature.parts) {
    const OGRPolygon polygon = geometry_of(part);
    parts->addGeometry(&polygon);
  }
  return parts;
}

void write(const std::string& path, const char* crs, const std::vector<HostileFeature>& features) {
  const GDALDatasetUniquePtr dataset = create_source(path, "FlatGeobuf");
  OGRSpatialReference reference;
  if (*crs != '\0') reference = test_reference(crs);
  const char* const options[] = {"SPATIAL_INDEX=NO", nullptr};
  OGRLayer* layer = dataset->CreateLayer("hostile", *crs != '\0' ? &reference : nullptr, wkbUnknown,
                                         const_cast<char**>(options));
  OGRFieldDefn text("text", OFTString);
  ASSERT_EQ(layer->CreateField(&text), OGRERR_NONE);
  for (const HostileFeature& feature : features) {
    const OGRFeatureUniquePtr row(OGRFeature::CreateFeature(layer->GetLayerDefn()));
    row->SetField("text", feature.text.c_str());
    row->SetGeometryDirectly(geometry_of(feature).release());
    ASSERT_EQ(layer->CreateFeature(row.get()), OGRERR_NONE) << CPLGetLastErrorMsg();
  }
}

/// A picture of the whole layer.
View view_of(const Box& bounds) {
  const auto width = static_cast<double>(std::int64_t{bounds.max_x} - bounds.min_x);
  const auto height = static_cast<double>(std::int64_t{bounds.max_y} - bounds.min_y);
  View view;
  view.origin_x = bounds.min_x;
  view.origin_y = bounds.min_y;
  view.cells_per_pixel = std::max({1.0, width / view.width, height / view.height});
  return view;
}

void draw(const Layer& layer, Level level) {
  if (layer.bounds().is_empty()) return;
  const View view = view_of(layer.bounds());
  std::vector<TrapezoidRange> ranges;
  layer.select({.box = view.box(), .level = level}, ranges);
  Mask mask;
  SoftwareRenderer().draw(layer.mesh(), ranges, view, mask);
}

void expect_is_accounted_for(const LoadReport& report, std::size_t features) {
  EXPECT_EQ(report.features, features);
  EXPECT_EQ(report.loaded + report.skipped + report.empty + report.other_geometry, features);
  EXPECT_GE(report.notes.size(), report.skipped);
  for (const FeatureNote& note : report.notes) EXPECT_NE(note.reason, "");
}

void expect_memory_is_bounded(const LoadedLayer& loaded) {
  EXPECT_LE(loaded.layer->memory(), kMostBytesBeside + kMostBytesAVertex * loaded.report.vertices)
      << loaded.report.vertices << " vertices, " << loaded.layer->size().motes << " motes";
}

class HostilePolygonsTest : public ::testing::TestWithParam<HostileInput> {
 protected:
  /// Empty if the source was refused with a message.
  LoadedLayer load(CoverageMode coverage) const {
    LoadOptions options;
    options.generalization.coverage = coverage;
    try {
      return load_layer(path_, options);
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), StartsWith(path_ + ": "));
      return {};
    }
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.file("hostile.fgb");
};

TEST_P(HostilePolygonsTest, AreLoadedOrRefusedInWordsAndDrawn) {
  const std::vector<HostileFeature> features = GetParam().make();
  ASSERT_NO_FATAL_FAILURE(write(path_, GetParam().crs, features));
  for (const CoverageMode coverage :
       {CoverageMode::off, CoverageMode::automatic, CoverageMode::on}) {
    SCOPED_TRACE("coverage " + std::string(kCoverageNames.name_of(coverage)));
    const LoadedLayer loaded = load(coverage);
    if (loaded.layer == nullptr) continue;
    expect_is_accounted_for(loaded.report, features.size());
    expect_memory_is_bounded(loaded);
    const Level of_picture = nearest_level(view_of(loaded.layer->bounds()).cells_per_pixel / 4);
    for (const Level level : {Level{0}, of_picture, kLastLevel}) draw(*loaded.layer, level);
  }
}

INSTANTIATE_TEST_SUITE_P(Inputs, HostilePolygonsTest, ::testing::ValuesIn(hostile_inputs()),
                         [](const auto& input) { return input.param.name; });

}  // namespace
}  // namespace trapeze
