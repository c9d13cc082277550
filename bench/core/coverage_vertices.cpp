#include "bench/core/coverage_vertices.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

constexpr const char* kMapshaperFolder = TRAPEZE_BENCH_FOLDER "/mapshaper";
// mapshaper uses 0.65 times the square root of an area as its distance.
constexpr double kDistanceOfArea = 0.65;

/// A feature next to an edge.
struct Beside {
  std::uint32_t edge;
  std::uint32_t feature;

  friend auto operator<=>(const Beside&, const Beside&) = default;
};

/// A feature at a vertex, or kNoFeature for the outside.
struct Around {
  std::uint32_t vertex;
  std::uint32_t feature;

  friend auto operator<=>(const Around&, const Around&) = default;
};

template <typename Item>
void sort_and_unite(std::vector<Item>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

std::vector<Beside> boundary_of(const Layer& layer, Level level) {
  std::vector<Beside> boundary;
  std::vector<TrapezoidRange> ranges;
  const auto add = [&](std::uint32_t i) {
    const MeshTrapezoid& t = layer.mesh().trapezoids[i];
    for (const std::uint32_t edge : {t.left, t.right}) {
      boundary.push_back({edge, layer.feature_of(i)});
    }
  };
  layer.select({layer.bounds(), level, level, SmallPolygons::drop}, ranges);
  for_each_trapezoid(ranges, add);
  layer.select_horizontal_edges(layer.bounds(), level, ranges);
  for_each_trapezoid(ranges, add);
  sort_and_unite(boundary);
  return boundary;
}

/// An edge with a single feature has the outside on its other side.
std::vector<Around> features_around(const MeshView& mesh, const std::vector<Beside>& boundary) {
  std::vector<Around> around;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const std::uint32_t edge = boundary[i].edge;
    const bool is_alone = (i == 0 || boundary[i - 1].edge != edge) &&
                          (i + 1 == boundary.size() || boundary[i + 1].edge != edge);
    for (const std::uint32_t v : {mesh.edges[edge].upper, mesh.edges[edge].lower}) {
      around.push_back({v, boundary[i].feature});
      if (is_alone) around.push_back({v, Layer::kNoFeature});
    }
  }
  sort_and_unite(around);
  return around;
}

std::size_t count_different(std::vector<Point>& points) {
  std::ranges::sort(points, is_above);
  return static_cast<std::size_t>(std::unique(points.begin(), points.end()) - points.begin());
}

double distance_of(WeightRule rule, double tolerance) {
  const double metres = tolerance * 2 * kMercatorHalfSide / static_cast<double>(kGridSize);
  return rule == WeightRule::effective_area ? kDistanceOfArea * metres : metres;
}

}  // namespace

VerticesLeft vertices_left(const Layer& layer, Level level) {
  const MeshView& mesh = layer.mesh();
  const std::vector<Around> around = features_around(mesh, boundary_of(layer, level));
  VerticesLeft left;
  std::vector<Point> positions;
  for (auto begin = around.begin(); begin != around.end();) {
    const auto end = std::find_if(
        begin, around.end(), [&](const Around& other) { return other.vertex != begin->vertex; });
    ++left.stored;
    left.junctions += end - begin >= 3;
    positions.push_back(mesh.vertices[begin->vertex]);
    begin = end;
  }
  left.positions = count_different(positions);
  return left;
}

Mapshaper::Mapshaper(const std::string& program, const std::string& file)
    : exported_(folder_.path() + "/coverage.geojson") {
  run_to_end({program, "export", file, "--zoom", "0", "--simplify", "0", "--coverage", "auto",
              "--crs", "EPSG:3857", "--output", exported_},
             folder_.path() + "/export.log");
}

bool Mapshaper::is_installed() {
  return std::filesystem::exists(std::string(kMapshaperFolder) + "/node_modules/mapshaper");
}

std::vector<std::size_t> Mapshaper::vertices_left(WeightRule rule,
                                                  const std::vector<double>& tolerances) const {
  const std::string output = folder_.path() + "/vertices";
  std::vector<std::string> arguments = {"node",
                                        "--max-old-space-size=8192",
                                        std::string(kMapshaperFolder) + "/count_vertices.mjs",
                                        exported_,
                                        rule == WeightRule::effective_area ? "visvalingam" : "dp",
                                        output};
  for (const double tolerance : tolerances) {
    arguments.push_back(std::to_string(distance_of(rule, tolerance)));
  }
  run_to_end(arguments, folder_.path() + "/mapshaper.log");
  std::vector<std::size_t> numbers;
  std::ifstream lines(output);
  for (std::size_t number = 0; lines >> number;) numbers.push_back(number);
  if (numbers.size() != tolerances.size()) throw std::runtime_error("mapshaper left out a zoom");
  return numbers;
}

}  // namespace trapeze
