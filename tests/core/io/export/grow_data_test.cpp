// Real polygons exported as grown, compared with the drawing of the same layer.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/grid/web_mercator.h"
#include "core/io/export/export_layer.h"
#include "core/io/load/load_layer.h"
#include "core/layer/layer.h"
#include "core/mesh/exaggeration.h"
#include "tests/core/io/data/source_rings.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

struct GrowTrial {
  const char* file;
  int zoom;
  double width;  // pixels
};

void PrintTo(const GrowTrial& trial, std::ostream* out) {
  *out << trial.file << " at " << trial.zoom;
}

constexpr double kMostOff = 1.5;  // cells, on average along the whole boundary

using Geometries = std::map<std::int64_t, std::unique_ptr<OGRGeometry>>;  // by trapeze_id

/// Invalid geometries fail the test.
Geometries geometries_of(const std::string& path) {
  Geometries geometries;
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  for (const auto& feature : *dataset->GetLayer(0)) {
    EXPECT_TRUE(feature->GetGeometryRef()->IsValid());
    geometries[feature->GetFieldAsInteger64("trapeze_id")].reset(feature->StealGeometry());
  }
  return geometries;
}

/// Calls visit(polygon) for each polygon of a geometry.
template <typename Visit>
void for_each_polygon(const OGRGeometry& geometry, const Visit& visit) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) return visit(*geometry.toPolygon());
  if (!OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) return;
  for (const OGRGeometry* part : *geometry.toGeometryCollection()) for_each_polygon(*part, visit);
}

double area_of(const OGRGeometry& geometry) {
  double sum = 0;
  for_each_polygon(geometry, [&](const OGRPolygon& polygon) { sum += polygon.get_Area(); });
  return sum;
}

double length_of(const OGRGeometry& geometry) {
  double sum = 0;
  for_each_polygon(geometry, [&](const OGRPolygon& polygon) {
    for (const OGRLinearRing* ring : polygon) sum += ring->get_Length();
  });
  return sum;
}

/// The grown triangles of a layer, as in a tile of the zoom that shows all of it.
std::vector<Exaggeration::Triangle> drawn_triangles(const Layer& layer, Level level,
                                                    const Exaggeration::Size& size) {
  constexpr Box kEverywhere{kGridMin, kGridMin, kGridMax, kGridMax};
  const MeshView& mesh = layer.mesh();
  Exaggeration exaggeration;
  BoundaryMap& boundary = exaggeration.boundary();
  boundary.begin();
  boundary.begin_piece(mesh);
  const auto stays = [&](std::uint32_t i) {
    return !layer.overlaps().of(layer.feature_of(i)).empty();
  };
  std::vector<TrapezoidRange> ranges;
  layer.select({kEverywhere, level, 0, SmallPolygons::drop}, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    if (!stays(i)) boundary.add(mesh.trapezoids[i], layer.feature_of(i));
  });
  layer.select_horizontal_edges(kEverywhere, level, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    if (!stays(i)) boundary.add_edge(mesh.trapezoids[i].left);
  });
  exaggeration.find(size, layer.bounds(), nullptr);
  return {exaggeration.triangles().begin(), exaggeration.triangles().end()};
}

OGRPolygon polygon_of(const Exaggeration::Triangle& triangle) {
  OGRLinearRing ring;
  for (const std::size_t i : {0, 1, 2, 0}) {
    const GridPosition p = metres_from_grid(triangle.corners[i].x, triangle.corners[i].y);
    ring.addPoint(p.x, p.y);
  }
  OGRPolygon polygon;
  polygon.addRing(&ring);
  return polygon;
}

class GrowDataTest : public ::testing::TestWithParam<GrowTrial> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    path_ = (std::filesystem::path(data) / GetParam().file).string();
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << path_ << " is not there";
    options_.epsilon = testing::epsilon_of_zoom(GetParam().zoom);
    pixel_ = static_cast<double>(TileId{GetParam().zoom, 0, 0}.side()) / 256;
  }

  TemporaryFolder folder_;
  std::string path_;
  ExportOptions options_;
  double pixel_ = 1;  // cells
};

// Up to the effects of rounding to cells.
TEST_P(GrowDataTest, EveryFeatureIsWhatIsDrawnOfIt) {
  const double cell = metres_from_grid(1, 0).x;
  options_.crs = ExportCrs::web_mercator;
  const auto write = [&](const char* name, double width) {
    options_.grow = {width, pixel_};
    const ExportReport report = export_layer(path_, folder_.file(name), options_);
    EXPECT_EQ(report.grown > 0, width > 0);
    EXPECT_EQ(report.skipped, 0u);
    return geometries_of(folder_.file(name));
  };
  const Geometries before = write("before.gpkg", 0);
  const Geometries after = write("after.gpkg", GetParam().width);
  ASSERT_EQ(before.size(), after.size());

  const LoadedLayer loaded = load_layer(path_, {.generalization = options_.generalization});
  const FeatureTable& table = loaded.layer->features();
  struct Feature {
    OGREnvelope around;
    bool stays = false;
    OGRMultiPolygon own;
    OGRMultiPolygon own_over_others;
    OGRMultiPolygon of_others_over_it;
  };
  std::map<std::int64_t, Feature> features;
  const double reach = 2 * GetParam().width * pixel_ * cell;
  for (const auto& [id, geometry] : before) {
    OGREnvelope& around = features[id].around;
    geometry->getEnvelope(&around);
    around.Merge(around.MinX - reach, around.MinY - reach);
    around.Merge(around.MaxX + reach, around.MaxY + reach);
  }
  for (std::uint32_t row = 0; row < table.size(); ++row) {
    const auto found = features.find(table.id(row));
    if (found != features.end()) found->second.stays = !loaded.layer->overlaps().of(row).empty();
  }
  for (const Exaggeration::Triangle& triangle : drawn_triangles(
           *loaded.layer, nearest_level(options_.epsilon), {GetParam().width, pixel_})) {
    const OGRPolygon polygon = polygon_of(triangle);
    const std::int64_t id = table.id(BoundaryMap::number_of(triangle.face));
    features[id].own.addGeometry(&polygon);
    if (!triangle.is_beside_others) continue;
    features[id].own_over_others.addGeometry(&polygon);
    OGREnvelope around;
    polygon.getEnvelope(&around);
    for (auto& [other, feature] : features) {
      if (other != id && around.Intersects(feature.around)) {
        feature.of_others_over_it.addGeometry(&polygon);
      }
    }
  }
  using Geometry = std::unique_ptr<OGRGeometry>;
  const double pixel_area = pixel_ * pixel_ * cell * cell;
  double disputed = 0;
  for (const auto& [id, geometry] : after) {
    const Feature& feature = features.at(id);
    if (feature.stays) {
      EXPECT_TRUE(geometry->Equals(before.at(id).get())) << "feature " << id;
      continue;
    }
    const Geometry own(feature.own.UnionCascaded());
    const Geometry own_over_others(feature.own_over_others.UnionCascaded());
    const Geometry lost(feature.of_others_over_it.UnionCascaded());
    const double rounding = kMostOff * cell * length_of(*geometry);
    // It covers only its original area and the area it has grown over; ...
    const Geometry all(before.at(id)->Union(own.get()));
    const Geometry beyond(geometry->Difference(all.get()));
    EXPECT_LE(area_of(*beyond), rounding) << "feature " << id;
    // ... it gives up the area that others grow over, unless it grows there as well; ...
    const Geometry gone(lost->Difference(own.get()));
    const Geometry kept(gone->Intersection(geometry.get()));
    EXPECT_LE(area_of(*kept), rounding) << "feature " << id;
    // ... and it covers all it grows over, unless others grow there as well.
    const Geometry taken(own_over_others->Difference(lost.get()));
    const Geometry missing(taken->Difference(geometry.get()));
    EXPECT_LE(area_of(*missing), rounding) << "feature " << id;
    const Geometry left(all->Difference(lost.get()));
    const Geometry others(left->Difference(geometry.get()));
    disputed += area_of(*others);
  }
  // Areas drawn twice, as ways may cross a little between samples, belong to one of the two.
  EXPECT_LE(disputed / pixel_area, 0.05 * static_cast<double>(after.size()));
}

// An edge is straight elsewhere in degrees, so vertices beside it would end up on its other side.
TEST_P(GrowDataTest, EverythingIsValidInDegrees) {
  options_.grow = {16, pixel_};
  const ExportReport report = export_layer(path_, folder_.file("out.gpkg"), options_);
  EXPECT_EQ(report.invalid, 0u);
  EXPECT_EQ(report.skipped, 0u);
  EXPECT_EQ(geometries_of(folder_.file("out.gpkg")).size(), report.written);
}

INSTANTIATE_TEST_SUITE_P(
    Files, GrowDataTest,
    ::testing::Values(GrowTrial{"malta_natural.fgb", 13, 3}, GrowTrial{"malta_landuse.fgb", 12, 4},
                      GrowTrial{"shenzhen_water.fgb", 10, 4}, GrowTrial{"us_counties.fgb", 4, 3},
                      GrowTrial{"europe_countries.fgb", 4, 3}),
    [](const auto& test) { return std::filesystem::path(test.param.file).stem().string(); });

}  // namespace
}  // namespace trapeze
