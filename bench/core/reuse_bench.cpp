// The cost of preparing again after one feature in a thousand has changed: reusing the earlier
// prepared file, and from scratch, in turns.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <ogrsf_frmts.h>
#include <CLI/CLI.hpp>

#include "bench/measure/figures.h"
#include "bench/measure/run_program.h"
#include "bench/server/trapeze_server.h"
#include "core/io/load/load_layer.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/source/source_stamp.h"

namespace trapeze {
namespace {

using Features = std::vector<std::unique_ptr<OGRPolygon>>;

struct Options {
  std::vector<std::string> layers = {"parcels", "shenzhen_buildings", "melbourne_landuse"};
  int blocks = 4000;
  int rounds = 5;
  double changed = 0.001;
  std::string json = "out/bench/reuse.json";
};

/// Blocks of 6 x 4 parcels, with streets between them: borders share vertices, three on each side
/// of a parcel besides its corners.
Features make_parcels(int blocks) {
  constexpr double kSize = 0.0004;  // degrees
  constexpr int kWide = 6;
  constexpr int kHigh = 4;
  constexpr int kSteps = 4;  // per side
  std::mt19937 random(1);
  std::uniform_real_distribution<double> off(-0.05, 0.05);
  const int columns = std::max(1, static_cast<int>(std::sqrt(blocks)));
  Features features;
  for (int block = 0; block < blocks; ++block) {
    const double x0 = 10 + (block % columns) * kSize * (kWide + 1);
    const double y0 = 45 + (block / columns) * kSize * (kHigh + 1);
    // A lattice of all possible positions of vertices, each slightly moved.
    constexpr int kAcross = kWide * kSteps + 1;
    std::vector<OGRPoint> lattice;
    for (int y = 0; y <= kHigh * kSteps; ++y) {
      for (int x = 0; x < kAcross; ++x) {
        lattice.emplace_back(x0 + kSize * (static_cast<double>(x) / kSteps + off(random)),
                             y0 + kSize * (static_cast<double>(y) / kSteps + off(random)));
      }
    }
    for (int y = 0; y < kHigh; ++y) {
      for (int x = 0; x < kWide; ++x) {
        OGRLinearRing ring;
        const auto add = [&](int dx, int dy) {
          ring.addPoint(
              &lattice[static_cast<std::size_t>((y * kSteps + dy) * kAcross + x * kSteps + dx)]);
        };
        for (int i = 0; i < kSteps; ++i) add(i, 0);
        for (int i = 0; i < kSteps; ++i) add(kSteps, i);
        for (int i = kSteps; i > 0; --i) add(i, kSteps);
        for (int i = kSteps; i >= 0; --i) add(0, i);
        features.push_back(std::make_unique<OGRPolygon>());
        features.back()->addRing(&ring);
      }
    }
  }
  return features;
}

/// The polygons of a file; each part of a multipolygon is a feature.
Features read_features(const std::string& path) {
  const GDALDatasetUniquePtr source(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  if (source == nullptr) throw std::runtime_error(path + ": cannot be opened");
  Features features;
  for (const auto& feature : source->GetLayer(0)) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr || geometry->IsEmpty()) continue;
    if (wkbFlatten(geometry->getGeometryType()) == wkbPolygon) {
      features.emplace_back(geometry->toPolygon()->clone());
    } else if (wkbFlatten(geometry->getGeometryType()) == wkbMultiPolygon) {
      for (const OGRPolygon* part : geometry->toMultiPolygon())
        features.emplace_back(part->clone());
    }
  }
  return features;
}

void write(const Features& features, const std::string& path) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("FlatGeobuf");
  const GDALDatasetUniquePtr out(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  OGRSpatialReference degrees;
  degrees.SetFromUserInput("OGC:CRS84");
  CPLStringList options;
  options.SetNameValue("SPATIAL_INDEX", "NO");  // which would change their order
  OGRLayer* layer = out->CreateLayer("layer", &degrees, wkbPolygon, options.List());
  for (const auto& polygon : features) {
    const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer->GetLayerDefn()));
    feature->SetGeometry(polygon.get());
    if (layer->CreateFeature(feature.get()) != OGRERR_NONE) {
      throw std::runtime_error(path + ": cannot be written");
    }
  }
}

/// Moves a vertex of each feature in that share by some metres.
void change(double share, Features& features) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> by(-5e-5, 5e-5);
  const auto count =
      static_cast<std::size_t>(std::ceil(share * static_cast<double>(features.size())));
  for (std::size_t i = 0; i < count; ++i) {
    OGRLinearRing& ring = *features[random() % features.size()]->getExteriorRing();
    if (ring.getNumPoints() < 4) continue;
    const int vertex =
        1 + static_cast<int>(random() % static_cast<unsigned>(ring.getNumPoints() - 2));
    ring.setPoint(vertex, ring.getX(vertex) + by(random), ring.getY(vertex) + by(random));
  }
}

struct Seconds {
  double beyond_reading = std::numeric_limits<double>::infinity();  // including writing
  double all = std::numeric_limits<double>::infinity();
  std::size_t taken_over = 0;
  std::size_t features = 0;
};

/// Prepares the source, and keeps the shortest times. Opening the earlier prepared file is
/// included.
void prepare(const std::string& source, const std::string& earlier, const std::string& output,
             Seconds& shortest) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto since_start = [&] {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  LoadOptions options;
  EarlierPrepared before;
  if (!earlier.empty()) before = open_earlier_layer(earlier, {});
  options.earlier = before.layer;
  const LoadedLayer loaded = load_layer(source, options);
  save_prepared_layer(output, loaded, 1, stamp_source(source), {}, before);
  const double all = since_start();
  shortest.beyond_reading = std::min(shortest.beyond_reading, all - loaded.report.read_seconds);
  shortest.all = std::min(shortest.all, all);
  shortest.taken_over = loaded.report.taken_over;
  shortest.features = loaded.report.loaded;
}

Features features_of(const Options& options, const std::string& layer) {
  if (layer == "parcels") return make_parcels(options.blocks);
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) throw std::runtime_error("TRAPEZE_DATA is not set");
  return read_features(std::string(folder) + "/" + layer + ".fgb");
}

Figure measure(const Options& options, const std::string& layer, const std::string& folder) {
  const auto path = [&](const std::string& name) { return folder + "/" + name; };
  Features features = features_of(options, layer);
  write(features, path("before.fgb"));
  change(options.changed, features);
  write(features, path("after.fgb"));
  Seconds unused;
  prepare(path("before.fgb"), "", path("before.trapeze"), unused);
  Seconds anew;
  Seconds again;
  for (int round = 0; round < options.rounds; ++round) {
    prepare(path("after.fgb"), "", path("anew.trapeze"), anew);
    prepare(path("after.fgb"), path("before.trapeze"), path("again.trapeze"), again);
  }
  Figure figure("reuse/" + layer);
  figure.set("features", static_cast<double>(again.features));
  figure.set("taken over", static_cast<double>(again.taken_over));
  figure.set("anew beyond reading, s", anew.beyond_reading);
  figure.set("again beyond reading, s", again.beyond_reading);
  figure.set("beyond reading, again / anew", again.beyond_reading / anew.beyond_reading);
  figure.set("anew with reading, s", anew.all);
  figure.set("again with reading, s", again.all);
  figure.set("with reading, again / anew", again.all / anew.all);
  for (const char* name : {"before.fgb", "after.fgb"}) std::filesystem::remove(path(name));
  return figure;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("What preparing again costs when little has changed (TRAPEZE_DATA)");
  app.add_option("--layer", options.layers, "Files without .fgb; parcels are made")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--blocks", options.blocks, "Of 24 parcels each")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--changed", options.changed, "The share of features that have changed")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "How often each is prepared; the shortest time counts")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  GDALAllRegister();
  const ScratchFolder folder;
  std::vector<Figure> figures;
  for (const std::string& layer : options.layers) {
    figures.push_back(measure(options, layer, folder.path()));
    print_line(figures.back());
  }
  write_figures(figures, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("reuse_bench", trapeze::run, argc, argv);
}
