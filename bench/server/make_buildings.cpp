// Writes artificial buildings: towns of 2,500 small blocks with gaps between them, on a grid of as
// many towns as needed. The output is a FlatGeobuf without an index, written in constant memory, or
// with its spatial index, for which GDAL keeps some 100 bytes per building. The same number gives
// the same file on every machine.
//
//   make_buildings FILE.fgb BUILDINGS [index]

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>

#include <ogrsf_frmts.h>

namespace {

constexpr int kLotsOfTown = 50;  // along each side
constexpr int kBuildingsOfTown = kLotsOfTown * kLotsOfTown;
constexpr double kLot = 3.0e-4;   // degrees
constexpr double kTown = 5.0e-2;  // from one town to the next
constexpr double kWest = 2;
constexpr double kNorth = 54;

/// The same on every machine, unlike the distributions of the standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
  /// At least 0, less than 1.
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

/// A block with one corner cut out and another one cut off, rotated: seven vertices.
void draw_building(Random& random, double x, double y, OGRLinearRing& ring) {
  const double width = kLot * (0.25 + 0.15 * random.next());
  const double depth = kLot * (0.25 + 0.15 * random.next());
  const double notch = 0.3 + 0.3 * random.next();
  const double angle = 3.14159265358979 * random.next();
  const double corners[7][2] = {{-1, -1},       {1, -1},   {1, notch - 1}, {1 - notch, notch - 1},
                                {1 - notch, 1}, {-0.8, 1}, {-1, 0.8}};
  ring.empty();
  for (int i = 0; i <= 7; ++i) {
    const double along = corners[i % 7][0] * width / 1.42;
    const double across = corners[i % 7][1] * depth / 1.42;
    ring.addPoint(x + along * std::cos(angle) - across * std::sin(angle),
                  y + along * std::sin(angle) + across * std::cos(angle));
  }
}

void require(bool is_done, const char* what) {
  if (!is_done) throw std::runtime_error(what);
}

void make(const std::string& path, std::int64_t count, bool has_index) {
  GDALAllRegister();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("FlatGeobuf");
  require(driver != nullptr, "GDAL has no FlatGeobuf");
  GDALDatasetUniquePtr file(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  require(file != nullptr, "the file cannot be made");
  OGRSpatialReference degrees;
  degrees.SetWellKnownGeogCS("WGS84");
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  char index_off[] = "SPATIAL_INDEX=NO";
  char* options[] = {has_index ? nullptr : index_off, nullptr};
  OGRLayer* layer = file->CreateLayer("buildings", &degrees, wkbPolygon, options);
  require(layer != nullptr, "the layer cannot be made");
  OGRFieldDefn height("height", OFTInteger);
  OGRFieldDefn use("use", OFTString);
  require(layer->CreateField(&height) == OGRERR_NONE && layer->CreateField(&use) == OGRERR_NONE,
          "a field cannot be made");
  const char* const uses[] = {"house", "flat",   "shop",  "school",
                              "barn",  "garage", "works", "church"};
  const auto towns = (count + kBuildingsOfTown - 1) / kBuildingsOfTown;
  const auto columns =
      static_cast<std::int64_t>(std::ceil(std::sqrt(1.6 * static_cast<double>(towns))));
  OGRFeature feature(layer->GetLayerDefn());
  for (std::int64_t i = 0; i < count; ++i) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const std::int64_t town = i / kBuildingsOfTown;
    const std::int64_t lot = i % kBuildingsOfTown;
    const double x = kWest + kTown * static_cast<double>(town % columns) +
                     kLot * static_cast<double>(lot % kLotsOfTown);
    const double y = kNorth - kTown * static_cast<double>(town / columns) -
                     kLot * static_cast<double>(lot / kLotsOfTown);
    OGRLinearRing ring;
    draw_building(random, x, y, ring);
    OGRPolygon polygon;
    polygon.addRing(&ring);
    feature.SetFID(OGRNullFID);
    feature.SetGeometry(&polygon);
    feature.SetField(0, 3 + static_cast<int>(30 * random.next()));
    feature.SetField(1, uses[static_cast<int>(8 * random.next())]);
    require(layer->CreateFeature(&feature) == OGRERR_NONE, "a building cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool has_index = argc == 4 && std::string(argv[3]) == "index";
    if (argc != 3 && !has_index) {
      throw std::runtime_error("usage: make_buildings FILE.fgb BUILDINGS [index]");
    }
    make(argv[1], std::atoll(argv[2]), has_index);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_buildings: %s\n", error.what());
    return 1;
  }
}
