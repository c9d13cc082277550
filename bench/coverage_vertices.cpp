#include "bench/coverage_vertices.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "core/web_mercator.h"

namespace trapeze {
namespace {

constexpr const char* kMapshaperFolder = TRAPEZE_BENCH_FOLDER "/mapshaper";
// mapshaper takes 0.65 times the square root of an area for its distance.
constexpr double kDistanceOfArea = 0.65;

/// What lies beside an edge.
struct Beside {
  std::uint32_t edge;
  std::uint32_t feature;

  friend auto operator<=>(const Beside&, const Beside&) = default;
};

/// A feature, or kNoFeature for what none covers, at a vertex.
struct Around {
  Point vertex;
  std::uint32_t feature;

  friend bool operator==(const Around&, const Around&) = default;
};

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
  layer.select_level_edges(layer.bounds(), level, ranges);
  for_each_trapezoid(ranges, add);
  std::ranges::sort(boundary);
  boundary.erase(std::unique(boundary.begin(), boundary.end()), boundary.end());
  return boundary;
}

/// An edge with one feature beside it has the outside on its other side.
std::vector<Around> features_around(const MeshView& mesh, const std::vector<Beside>& boundary) {
  std::vector<Around> around;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const std::uint32_t edge = boundary[i].edge;
    const bool is_alone = (i == 0 || boundary[i - 1].edge != edge) &&
                          (i + 1 == boundary.size() || boundary[i + 1].edge != edge);
    for (const std::uint32_t v : {mesh.edges[edge].upper, mesh.edges[edge].lower}) {
      around.push_back({mesh.vertices[v], boundary[i].feature});
      if (is_alone) around.push_back({mesh.vertices[v], Layer::kNoFeature});
    }
  }
  std::ranges::sort(around, [](const Around& a, const Around& b) {
    return a.vertex == b.vertex ? a.feature < b.feature : is_above(a.vertex, b.vertex);
  });
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

std::size_t ends_of(const MeshView& mesh, const std::vector<Beside>& boundary) {
  std::vector<std::uint32_t> ends;
  for (const auto& [edge, feature] : boundary) {
    ends.push_back(mesh.edges[edge].upper);
    ends.push_back(mesh.edges[edge].lower);
  }
  std::ranges::sort(ends);
  return static_cast<std::size_t>(std::unique(ends.begin(), ends.end()) - ends.begin());
}

double distance_of(WeightRule rule, double tolerance) {
  const double metres = tolerance * 2 * kMercatorHalfSide / static_cast<double>(kGridSize);
  return rule == WeightRule::effective_area ? kDistanceOfArea * metres : metres;
}

}  // namespace

VerticesLeft vertices_left(const Layer& layer, Level level) {
  const std::vector<Beside> boundary = boundary_of(layer, level);
  VerticesLeft left;
  left.stored = ends_of(layer.mesh(), boundary);
  const std::vector<Around> around = features_around(layer.mesh(), boundary);
  for (auto begin = around.begin(); begin != around.end();) {
    const auto end = std::find_if(
        begin, around.end(), [&](const Around& other) { return other.vertex != begin->vertex; });
    ++left.positions;
    left.junctions += end - begin >= 3;
    begin = end;
  }
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
