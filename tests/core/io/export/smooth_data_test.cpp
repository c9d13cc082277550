// Real polygons exported with round corners, compared with the drawing of the same layer.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "core/io/export/export_layer.h"
#include "core/io/load/load_layer.h"
#include "core/layer/layer.h"
#include "core/mesh/corner_rounding.h"
#include "tests/core/io/data/source_rings.h"
#include "tests/core/io/export/exported_cells.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using testing::SegmentCounts;

struct SmoothTrial {
  const char* file;
  int zoom;
  CoverageMode coverage = kUsualCoverage;
};

void PrintTo(const SmoothTrial& trial, std::ostream* out) {
  *out << trial.file << " at " << trial.zoom;
}

constexpr double kRadius = 8;                      // pixels
constexpr std::size_t kMostSegmentsOfCorner = 26;  // chords, and the rest of both edges

struct Drawn {
  SegmentCounts segments;  // how many features each bounds; negative for horizontal ones
  std::size_t corners = 0;
};

/// All outlines of a layer, as in a tile of the zoom that shows all of it.
Drawn drawn_outlines(const Layer& layer, Level level, double pixel) {
  constexpr Box kEverywhere{kGridMin, kGridMin, kGridMax, kGridMax};
  const MeshView& mesh = layer.mesh();
  CornerRounding corners;
  corners.begin();
  corners.begin_piece(mesh);
  std::vector<TrapezoidRange> ranges;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;  // of an edge, for each feature
  const auto is_sharp = [&](std::uint32_t row) { return !layer.overlaps().of(row).empty(); };
  const auto is_cut = [&](std::uint32_t edge) {
    return is_on_frame(mesh.vertices[mesh.edges[edge].upper],
                       mesh.vertices[mesh.edges[edge].lower]);
  };
  layer.select({kEverywhere, level, 0, SmallPolygons::drop}, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const MeshTrapezoid& t = mesh.trapezoids[i];
    const std::uint32_t row = layer.feature_of(i);
    corners.add(t, row, is_sharp(row));
    if (is_cut(t.left)) corners.add_edge(t.left, true);
    if (is_cut(t.right)) corners.add_edge(t.right, true);
    sides[{t.left, row}] |= 1;
    sides[{t.right, row}] |= 2;
  });
  std::map<std::uint32_t, int> edges;
  for (const auto& [edge_and_row, beside] : sides) {
    if (beside != 3) ++edges[edge_and_row.first];
  }
  layer.select_horizontal_edges(kEverywhere, level, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const std::uint32_t edge = mesh.trapezoids[i].left;
    corners.add_edge(edge, is_sharp(layer.feature_of(i)) || is_cut(edge));
    edges[edge] = -1;
  });
  corners.find({kRadius, pixel});
  Drawn drawn;
  drawn.corners = corners.corners().size();
  std::vector<PlateCarreeMesh::PointOnWay> way;
  for (const auto& [edge, count] : edges) {
    corners.trace(0, mesh, edge, way);
    for (std::size_t i = 1; i < way.size(); ++i) {
      int& of_segment = drawn.segments[testing::downwards(way[i - 1].place, way[i].place)];
      of_segment = count < 0 ? -1 : of_segment + count;
    }
  }
  return drawn;
}

class SmoothDataTest : public ::testing::TestWithParam<SmoothTrial> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    path_ = (std::filesystem::path(data) / GetParam().file).string();
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << path_ << " is not there";
    options_.epsilon = testing::epsilon_of_zoom(GetParam().zoom);
    options_.generalization.coverage = GetParam().coverage;
    options_.crs = ExportCrs::web_mercator;
    options_.overwrite = true;
    pixel_ = static_cast<double>(TileId{GetParam().zoom, 0, 0}.side()) / 256;
    options_.smooth = {kRadius, pixel_};
  }

  std::string output() const { return folder_.file("out.gpkg"); }

  TemporaryFolder folder_;
  std::string path_;
  ExportOptions options_;
  double pixel_ = 1;
};

// The same number of features bounds each segment: neighbours share their whole borders, and there
// are no gaps or overlaps that are not drawn.
TEST_P(SmoothDataTest, EveryFeatureIsOutlinedAsItIsDrawn) {
  const RoundedCorners corners = export_layer(path_, output(), options_).corners;
  EXPECT_GT(corners.rounded, 0u);
  EXPECT_LT(corners.refused, 10u);
  const SegmentCounts written = testing::segments_of(testing::exported_rings(output()));
  const LoadedLayer loaded = load_layer(path_, {.generalization = options_.generalization});
  const Drawn drawn = drawn_outlines(*loaded.layer, nearest_level(options_.epsilon), pixel_);
  EXPECT_EQ(corners.rounded + corners.refused, drawn.corners);
  std::size_t others = 0;
  for (const auto& [segment, count] : drawn.segments) {
    const auto found = written.find(segment);
    others += found != written.end() && (count < 0 || found->second == count) ? 0 : 1;
  }
  EXPECT_LE(others, kMostSegmentsOfCorner * corners.refused);
  EXPECT_LE(written.size(), drawn.segments.size());
}

INSTANTIATE_TEST_SUITE_P(
    Files, SmoothDataTest,
    ::testing::Values(SmoothTrial{"malta_landuse.fgb", 12}, SmoothTrial{"malta_natural.fgb", 15},
                      SmoothTrial{"shenzhen_buildings.fgb", 14}, SmoothTrial{"us_counties.fgb", 5},
                      SmoothTrial{"lands_complex.fgb", 2}, SmoothTrial{"europe_countries.fgb", 4},
                      SmoothTrial{"malta_landuse.fgb", 14, CoverageMode::off}),
    [](const auto& test) {
      return std::filesystem::path(test.param.file).stem().string() + "_" +
             std::to_string(test.param.zoom);
    });

}  // namespace
}  // namespace trapeze
