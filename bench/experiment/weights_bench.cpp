// Compares the effect of the rules for vertex weights on shapes.
//
//   TRAPEZE_DATA=folder weights_bench
//
// Every feature of a layer is simplified by each rule, with topology, until the total number of
// remaining vertices is the same as with Douglas-Peucker at a given number of pixels: tolerances
// are not comparable between rules, but maps with equal numbers of vertices are. For the result,
// reports how many corners are right angles, areas, and distances from the original.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "bench/core/source_rings.h"
#include "bench/experiment/quality.h"
#include "bench/measure/figures.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "core/adapt/adaptable_graph.h"
#include "core/borders/polygons.h"
#include "core/sweep/graph_builder.h"
#include "render/mask/mask.h"

namespace trapeze {
namespace {

constexpr double kRightWithin = 5;  // degrees

struct Options {
  std::vector<std::string> layers{"shenzhen_buildings:13,14,15,16", "kobroor:5,7,9,11"};
  double pixels = 1;
  std::string json = "out/bench/weights.json";
};

struct Feature {
  Rings source;
  double area = 0;
  std::unique_ptr<AdaptableGraph> graph;
};

double area_of(const TrapezoidalGraph& graph) {
  return static_cast<double>(graph.doubled_area()) / 2;
}

std::vector<Feature> features_of(const std::vector<Rings>& all, WeightRule rule) {
  std::vector<Feature> features;
  GraphBuilder builder;
  for (Rings rings : all) {
    TrapezoidalGraph graph;
    if (!builder.build(rings, graph).built) continue;
    Feature feature{rings_of(graph), area_of(graph), nullptr};
    feature.graph =
        std::make_unique<AdaptableGraph>(std::move(graph), GeneralizationOptions{.weights = rule});
    features.push_back(std::move(feature));
  }
  return features;
}

std::size_t vertices_at(std::vector<Feature>& features, double epsilon) {
  std::size_t vertices = 0;
  for (Feature& feature : features) {
    feature.graph->adapt_to(epsilon);
    vertices += rings_of(feature.graph->graph()).points.size();
  }
  return vertices;
}

/// The greatest tolerance, to a thousandth, that leaves at least that many vertices.
double tolerance_leaving(std::vector<Feature>& features, std::size_t vertices) {
  double least = 0.5;  // binary logarithms
  double greatest = 31;
  while (greatest - least > 1e-3) {
    const double middle = (least + greatest) / 2;
    (vertices_at(features, std::exp2(middle)) >= vertices ? least : greatest) = middle;
  }
  return std::exp2(least);
}

bool is_right(Point p, Point v, Point q) {
  const double px = static_cast<double>(p.x) - v.x;
  const double py = static_cast<double>(p.y) - v.y;
  const double qx = static_cast<double>(q.x) - v.x;
  const double qy = static_cast<double>(q.y) - v.y;
  const double off =
      90 - std::acos((px * qx + py * qy) / (std::hypot(px, py) * std::hypot(qx, qy))) * 180 / M_PI;
  return std::abs(off) <= kRightWithin;
}

std::size_t right_angles_of(const Rings& rings) {
  std::size_t count = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto ring = rings[r];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      count +=
          is_right(ring[(i + ring.size() - 1) % ring.size()], ring[i], ring[(i + 1) % ring.size()]);
    }
  }
  return count;
}

Figure figure_of(const std::string& name, std::vector<Feature>& features, double epsilon,
                 double pixel) {
  double vertices = 0;
  double gone = 0;
  double before = 0;
  double changed = 0;
  double right_before = 0;
  double right = 0;
  double greatest = 0;
  double distances = 0;
  for (Feature& feature : features) {
    feature.graph->adapt_to(epsilon);
    const Rings left = rings_of(feature.graph->graph());
    vertices += static_cast<double>(left.points.size());
    right += static_cast<double>(right_angles_of(left));
    right_before += static_cast<double>(right_angles_of(feature.source));
    before += feature.area;
    changed += std::abs(area_of(feature.graph->graph()) - feature.area);
    if (left.empty()) {
      ++gone;
      continue;
    }
    const double distance = experiment::distance_between(feature.source, left) / pixel;
    greatest = std::max(greatest, distance);
    distances += distance;
  }
  const double there = static_cast<double>(features.size()) - gone;
  Figure figure(name);
  figure.set("tolerance, pixels", epsilon / pixel);
  figure.set("vertices", vertices);
  figure.set("features gone", gone);
  figure.set("right angles, % of corners", 100 * right / std::max(vertices, 1.0));
  figure.set("right angles, % of those before", 100 * right / std::max(right_before, 1.0));
  figure.set("area error, %", 100 * changed / before);
  figure.set("Hausdorff distance, mean, pixels", distances / std::max(there, 1.0));
  figure.set("Hausdorff distance, greatest, pixels", greatest);
  return figure;
}

void print(const Figure& figure) {
  std::printf("%-48s", figure.name().c_str());
  for (const auto& [what, value] : figure.values()) std::printf(" %11.5g", value);
  std::printf("\n");
  std::fflush(stdout);
}

void print_head() {
  std::printf(
      "Hausdorff greatest px, mean px, area error %%, features gone, right %% of corners, "
      "right %% of those before, tolerance px, vertices\n");
}

/// `text` is the name of a file without .fgb, a colon, and zooms.
void measure(const std::string& text, double pixels, std::vector<Figure>& figures) {
  const std::size_t colon = text.find(':');
  const std::string layer = text.substr(0, colon);
  std::vector<int> zooms;
  for (const std::string& zoom : CLI::detail::split(text.substr(colon + 1), ',')) {
    zooms.push_back(std::stoi(zoom));
  }
  const std::vector<Rings> rings = read_source_rings(real_data_folder() + "/" + layer + ".fgb");
  std::vector<std::size_t> wanted(zooms.size());
  for (const std::string_view rule : kWeightNames.names()) {
    std::vector<Feature> features = features_of(rings, kWeightNames.find(rule).value());
    for (std::size_t i = 0; i < zooms.size(); ++i) {
      const double pixel = View::of_tile(TileId{zooms[i], 0, 0}).cells_per_pixel;
      const bool is_first = rule == kWeightNames.names()[0];  // Douglas-Peucker
      if (is_first) wanted[i] = vertices_at(features, pixels * pixel);
      const double epsilon = is_first ? pixels * pixel : tolerance_leaving(features, wanted[i]);
      figures.push_back(
          figure_of(layer + "/zoom " + std::to_string(zooms[i]) + "/" + std::string(rule), features,
                    epsilon, pixel));
      print(figures.back());
    }
  }
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("What the rules for weights do to shapes (TRAPEZE_DATA)");
  app.add_option("--layer", options.layers, "Files without .fgb, each with a colon and zooms")
      ->capture_default_str();
  app.add_option("--pixels", options.pixels, "The tolerance of Douglas-Peucker")
      ->check(CLI::Range(0.01, 64.0))
      ->capture_default_str();
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<Figure> figures;
  print_head();
  for (const std::string& layer : options.layers) measure(layer, options.pixels, figures);
  write_figures(figures, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("weights_bench", trapeze::run, argc, argv);
}
