// How the time for a tile changes when the data around it grows: the same trip over one layer, over
// ten times that layer, and over a hundred times, with the copies around the original.
//
//   TRAPEZE_DATA=folder growth_bench
//
// Copies are shifted by whole tiles of zoom 7, further than a screen at zoom 10 reaches, so that a
// tile of the trip (zooms 10 to 17) shows the same picture with or without them; that is checked.
// Tiles are requested one at a time, in turns, from servers that run side by side. "zooms": tiles
// at every zoom from 0 to 20; at the lowest zooms they show the copies, too.
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/measure/figures.h"
#include "bench/measure/http_load.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "bench/server/trapeze_server.h"
#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

constexpr int kFirstTripZoom = 10;
constexpr double kShift = 2 * kMercatorHalfSide / (1 << (kFirstTripZoom - 3));  // metres

struct Options {
  std::string layer = "malta_buildings";
  std::vector<int> copies{1, 10, 100};
  std::vector<std::string> renderers{"egl", "software"};
  std::string program = built_trapeze();
  int rounds = 3;
  std::string json = "out/bench/growth.json";
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetPtr = std::unique_ptr<GDALDataset, CloseDataset>;

DatasetPtr open_dataset(const std::string& path) {
  DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (!dataset) throw std::runtime_error("cannot read " + path);
  return dataset;
}

/// All geometries of the first layer, in metres.
std::vector<std::unique_ptr<OGRGeometry>> read_in_metres(const std::string& path,
                                                         OGRSpatialReference& metres) {
  const DatasetPtr dataset = open_dataset(path);
  OGRLayer* layer = dataset->GetLayer(0);
  OGRSpatialReference source(*layer->GetSpatialRef());
  source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> transformation(
      OGRCreateCoordinateTransformation(&source, &metres));
  std::vector<std::unique_ptr<OGRGeometry>> geometries;
  for (const auto& feature : *layer) {
    if (feature->GetGeometryRef() == nullptr) continue;
    geometries.emplace_back(feature->StealGeometry());
    if (geometries.back()->transform(transformation.get()) != OGRERR_NONE) {
      throw std::runtime_error("cannot project " + path);
    }
  }
  return geometries;
}

/// Adds an offset to every coordinate.
class Shift : public OGRDefaultGeometryVisitor {
 public:
  Shift(double x, double y) : x_(x), y_(y) {}
  using OGRDefaultGeometryVisitor::visit;
  void visit(OGRPoint* point) override {
    point->setX(point->getX() + x_);
    point->setY(point->getY() + y_);
  }

 private:
  const double x_;
  const double y_;
};

/// The shift of the n-th copy in a square of copies that includes the original, n = 0.
Shift shift_of(int n, int copies) {
  const int side = static_cast<int>(std::ceil(std::sqrt(copies)));
  const int original = side / 2 * side + side / 2;
  const int place = (n + original) % (side * side);
  return {(place % side - side / 2) * kShift, (place / side - side / 2) * kShift};
}

void write_copies(const std::string& source, int copies, const std::string& path) {
  OGRSpatialReference metres;
  metres.importFromEPSG(3857);
  const auto geometries = read_in_metres(source, metres);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("FlatGeobuf");
  if (driver == nullptr) throw std::runtime_error("GDAL cannot write FlatGeobuf");
  const DatasetPtr dataset(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  const char* const layer_options[] = {"SPATIAL_INDEX=NO", nullptr};
  OGRLayer* layer = dataset ? dataset->CreateLayer("copies", &metres, wkbMultiPolygon,
                                                   const_cast<char**>(layer_options))
                            : nullptr;
  if (layer == nullptr) throw std::runtime_error("cannot write " + path);
  for (int n = 0; n < copies; ++n) {
    Shift shift = shift_of(n, copies);
    for (const auto& geometry : geometries) {
      OGRFeature feature(layer->GetLayerDefn());
      feature.SetGeometryDirectly(OGRGeometryFactory::forceToMultiPolygon(geometry->clone()));
      feature.GetGeometryRef()->accept(&shift);
      if (layer->CreateFeature(&feature) != OGRERR_NONE) {
        throw std::runtime_error("cannot write " + path);
      }
    }
  }
}

std::vector<std::string> pictures_of(const TrapezeServer& server, const Trip& trip) {
  return load_http(server.port(), tile_requests(trip), {.keep_bodies = true}).bodies;
}

/// The layer repeated that many times, with a server.
class Grown {
 public:
  Grown(const Options& options, const std::string& renderer, int copies,
        const std::vector<TileId>& trip_tiles, const std::vector<TileId>& zoom_tiles)
      : copies_(copies),
        name_("growth/trapeze-" + renderer + "/" + std::to_string(copies) + "x"),
        trip_(trip_of(options, trip_tiles)),
        zooms_{trip_.name, trip_.layers, zoom_tiles},
        server_(trip_.layers, {options.program, renderer}),
        along_trip_(name_ + "/trip"),
        along_zooms_(name_ + "/zooms"),
        trip_requests_(uncached_requests(trip_, options.rounds)),
        zoom_requests_(uncached_requests(zooms_, options.rounds, kColours / 2)) {
    along_trip_.set("seconds to ready", server_.seconds_to_ready());
  }
  Grown(const Grown&) = delete;
  Grown& operator=(const Grown&) = delete;

  void measure(int round) {
    along_trip_.add(timed(trip_, trip_requests_, round));
    along_zooms_.add(timed(zooms_, zoom_requests_, round));
  }

  /// Checks that the original looks the same as with other numbers of copies around it, whose
  /// pictures are given.
  void check_pictures(const std::vector<std::string>& others) const {
    const auto ours = pictures_of(server_, trip_);
    std::size_t different = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) different += ours[i] == others[i] ? 0 : 1;
    if (different == 0) return;
    std::printf("%s: %zu of %zu tiles look different from those of one copy\n", name_.c_str(),
                different, ours.size());
  }
  std::vector<std::string> pictures() const { return pictures_of(server_, trip_); }

  void compare_to(const Grown& one) {
    along_trip_.set("p50 against 1x",
                    along_trip_.percentiles().p50 / one.along_trip_.percentiles().p50);
    along_trip_.set("cpu against 1x",
                    along_trip_.cpu_ms_per_tile() / one.along_trip_.cpu_ms_per_tile());
  }
  const Figure& along_trip() const { return along_trip_; }
  const Figure& along_zooms() const { return along_zooms_; }

 private:
  Trip trip_of(const Options& options, const std::vector<TileId>& tiles) const {
    const std::string path = folder_.path() + "/copies.fgb";
    write_copies(real_data_folder() + "/" + options.layer + ".fgb", copies_, path);
    return {name_, {{"copies", path, "a05040"}}, tiles};
  }

  TileRun timed(const Trip& trip, const std::vector<std::string>& requests, int round) const {
    const std::size_t count = trip.tiles.size();
    const std::span<const std::string> all(requests);
    const double before = server_.cpu_seconds();
    TileRun run = tile_run(
        trip,
        load_http(server_.port(), all.subspan(static_cast<std::size_t>(round) * count, count),
                  {.connections = 1}),
        true);
    run.cpu_seconds = server_.cpu_seconds() - before;
    return run;
  }

  const int copies_;
  const std::string name_;
  const ScratchFolder folder_;
  const Trip trip_;
  const Trip zooms_;
  const TrapezeServer server_;
  Figure along_trip_;
  Figure along_zooms_;
  const std::vector<std::string> trip_requests_;
  const std::vector<std::string> zoom_requests_;
};

void measure_renderer(const Options& options, const std::string& renderer,
                      std::vector<Figure>& figures) {
  constexpr int kLastZoom = 20;
  constexpr std::size_t kTilesPerZoom = 20;
  const std::vector<TripLayer> layers{
      {options.layer, real_data_folder() + "/" + options.layer + ".fgb", ""}};
  const Places places = read_places(layers);
  const auto trip_tiles = make_trip(places, kFirstTripZoom, 17, kTripViews);
  const auto zoom_tiles = tiles_at_vertices(places, 0, kLastZoom, kTilesPerZoom);
  std::vector<std::unique_ptr<Grown>> all;
  for (const int copies : options.copies) {
    all.push_back(std::make_unique<Grown>(options, renderer, copies, trip_tiles, zoom_tiles));
  }
  for (int round = 0; round < options.rounds; ++round) {
    for (const auto& grown : all) grown->measure(round);
  }
  const auto pictures = all.front()->pictures();
  for (const auto& grown : all) {
    grown->compare_to(*all.front());
    print_line(grown->along_trip());
    print_line(grown->along_zooms());
    print_zooms(grown->along_zooms());
    grown->check_pictures(pictures);
    figures.push_back(grown->along_trip());
    figures.push_back(grown->along_zooms());
  }
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("How long a tile takes when the data around it grows (TRAPEZE_DATA)");
  app.add_option("--layer", options.layer, "A FlatGeobuf file of TRAPEZE_DATA, without .fgb")
      ->capture_default_str();
  app.add_option("--copies", options.copies, "How many times")
      ->delimiter(',')
      ->check(CLI::Range(1, 400))
      ->capture_default_str();
  app.add_option("--renderer", options.renderers)->delimiter(',')->capture_default_str();
  app.add_option("--server", options.program, "The program trapeze")->capture_default_str();
  app.add_option("--rounds", options.rounds, "How often all is measured")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  GDALAllRegister();
  std::vector<Figure> figures;
  print_table_head();
  for (const std::string& renderer : options.renderers) {
    measure_renderer(options, renderer, figures);
  }
  write_figures(figures, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("growth_bench", trapeze::run, argc, argv);
}
