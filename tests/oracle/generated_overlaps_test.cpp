// The pictures of polygons that overlap in every way are true.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <random>
#include <sstream>

#include "tests/oracle/held_to_truth.h"

namespace trapeze::oracle {
namespace {

constexpr TileName kTile{12, 2144, 1434};  // contains all shapes
const std::array<std::string, 4> kKinds = {"field", "wood", "lake", "town"};

/// In pixels of kTile.
using Ring = std::vector<Place>;
struct Shape {
  std::vector<Ring> rings;
  std::string kind;
};

double uniform(std::mt19937& random, double from, double to) {
  // No std distribution is used: these differ between standard libraries.
  return from + (to - from) * static_cast<double>(random()) / 4294967296.0;
}

const std::string& any_kind(std::mt19937& random) {
  return kKinds[random() % kKinds.size()];
}

Ring star(std::mt19937& random, Place centre, double radius) {
  const auto corners = 3 + static_cast<int>(random() % 12);
  Ring ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + uniform(random, 0, 0.8)) / corners;
    const double r = radius * uniform(random, 0.5, 1);
    ring.push_back({centre.x + r * std::cos(angle), centre.y + r * std::sin(angle)});
  }
  return ring;
}

Ring box(double west, double north, double east, double south) {
  return {{west, north}, {east, north}, {east, south}, {west, south}};
}

Place any_place(std::mt19937& random) {
  return {uniform(random, 10, 246), uniform(random, 10, 246)};
}

// Every random number has its own statement: compilers evaluate arguments in different orders.
Shape any_star(std::mt19937& random, double least_radius, double greatest_radius) {
  const Place centre = any_place(random);
  const double radius = uniform(random, least_radius, greatest_radius);
  const Ring ring = star(random, centre, radius);
  return {{ring}, any_kind(random)};
}

std::vector<Shape> stars_over_each_other(std::mt19937& random) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 40; ++i) {
    shapes.push_back(any_star(random, 2, 60));
  }
  return shapes;
}

/// Each shape lies in the one before; some have a hole that contains the next one.
std::vector<Shape> nested(std::mt19937& random) {
  std::vector<Shape> shapes;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const Place centre{45.3 + 80 * column, 44.7 + 80 * row};
      for (double half = 38; half > 2; half *= uniform(random, 0.5, 0.9)) {
        Shape shape{{box(centre.x - half, centre.y - half, centre.x + half, centre.y + half)},
                    any_kind(random)};
        const double hole = half / 3;
        if (random() % 4 == 0) {
          shape.rings.push_back(
              box(centre.x - hole, centre.y - hole, centre.x + hole, centre.y + hole));
        }
        shapes.push_back(shape);
      }
    }
  }
  return shapes;
}

/// Plots with shared borders, each drawn at random once.
std::vector<Shape> neighbours(std::mt19937& random) {
  constexpr int kPlots = 6;
  constexpr int kPieces = 8;  // of a border
  constexpr double kSide = 36;
  constexpr double kFrom = 20.4;
  std::vector<std::vector<Place>> corners(kPlots + 1, std::vector<Place>(kPlots + 1));
  for (int y = 0; y <= kPlots; ++y) {
    for (int x = 0; x <= kPlots; ++x) {
      corners[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = {
          kFrom + x * kSide + uniform(random, -6, 6), kFrom + y * kSide + uniform(random, -6, 6)};
    }
  }
  const auto corner = [&](int x, int y) {
    return corners[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
  };
  const auto border = [&](Place a, Place b, std::uint32_t seed) {
    std::mt19937 own(seed);
    Ring points = {a};
    for (int i = 1; i < kPieces; ++i) {
      const double share = static_cast<double>(i) / kPieces;
      points.push_back({a.x + share * (b.x - a.x) + uniform(own, -2, 2),
                        a.y + share * (b.y - a.y) + uniform(own, -2, 2)});
    }
    points.push_back(b);
    return points;
  };
  const auto seed = static_cast<std::uint32_t>(random());
  const auto across = [&](int x, int y) {
    return border(corner(x, y), corner(x + 1, y), seed + static_cast<std::uint32_t>(100 * y + x));
  };
  const auto down = [&](int x, int y) {
    return border(corner(x, y), corner(x, y + 1),
                  seed + static_cast<std::uint32_t>(10'000 + 100 * y + x));
  };
  std::vector<Shape> shapes;
  for (int y = 0; y < kPlots; ++y) {
    for (int x = 0; x < kPlots; ++x) {
      Ring ring = across(x, y);
      const auto append = [&ring](Ring points, bool is_reversed) {
        if (is_reversed) std::ranges::reverse(points);
        ring.insert(ring.end(), points.begin() + 1, points.end());
      };
      append(down(x + 1, y), false);
      append(across(x, y + 1), true);
      append(down(x, y), true);
      ring.pop_back();
      shapes.push_back({{ring}, any_kind(random)});
    }
  }
  return shapes;
}

/// Overlapping shapes with shared sides: halves and copies of the shapes below, and their
/// neighbours.
std::vector<Shape> coincident(std::mt19937& random) {
  std::vector<Shape> shapes;
  for (int i = 0; i < 12; ++i) {
    shapes.push_back(any_star(random, 15, 50));
    const Ring whole = shapes.back().rings.front();
    const std::size_t half = whole.size() / 2;
    if (half < 2) continue;
    shapes.push_back(
        {{Ring(whole.begin(), whole.begin() + static_cast<long>(half) + 1)}, any_kind(random)});
    if (random() % 3 == 0) shapes.push_back({{whole}, any_kind(random)});
    const Place a = whole[0];
    const Place b = whole[1];
    shapes.push_back({{{b, a, {a.x + (b.y - a.y), a.y - (b.x - a.x)}}}, any_kind(random)});
  }
  return shapes;
}

/// Plots with stars over them.
std::vector<Shape> stars_over_neighbours(std::mt19937& random) {
  std::vector<Shape> shapes = neighbours(random);
  for (int i = 0; i < 15; ++i) {
    shapes.push_back(any_star(random, 5, 40));
  }
  return shapes;
}

std::string geojson_of(const std::vector<Shape>& shapes) {
  const double side = std::exp2(kTile.zoom) * kPixels;
  std::ostringstream out;
  out << std::setprecision(15) << R"({"type":"FeatureCollection","features":[)";
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    out << (i > 0 ? "," : "") << R"({"type":"Feature","id":)" << i << R"(,"properties":{"kind":")"
        << shapes[i].kind << R"("},"geometry":{"type":"Polygon","coordinates":[)";
    for (std::size_t r = 0; r < shapes[i].rings.size(); ++r) {
      Ring ring = shapes[i].rings[r];
      ring.push_back(ring.front());
      out << (r > 0 ? ",[" : "[");
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const double x = (kTile.x * kPixels + ring[k].x) / side;
        const double y = (kTile.y * kPixels + ring[k].y) / side;
        const double lat = std::atan(std::sinh((0.5 - y) * 2 * std::numbers::pi));
        out << (k > 0 ? ",[" : "[") << (x - 0.5) * 360 << "," << lat * 180 / std::numbers::pi
            << "]";
      }
      out << "]";
    }
    out << "]}}";
  }
  out << "]}";
  return out.str();
}

/// A file that exists as long as the object.
class ShapeFile {
 public:
  ShapeFile(const std::string& name, const std::vector<Shape>& shapes)
      : folder_(std::filesystem::temp_directory_path() /
                ("trapeze-oracle-" + std::to_string(::getpid()) + "-" + name)) {
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / (name + ".geojson")).string();
    std::ofstream(path_) << geojson_of(shapes);
  }
  ~ShapeFile() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  ShapeFile(const ShapeFile&) = delete;
  ShapeFile& operator=(const ShapeFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::filesystem::path folder_;
  std::string path_;
};

/// The tile, one that contains it, and one inside it.
const std::array<TileName, 3> kTiles = {kTile, TileName{kTile.zoom - 1, kTile.x / 2, kTile.y / 2},
                                        TileName{kTile.zoom + 1, 2 * kTile.x + 1, 2 * kTile.y}};

const std::vector<Exception> kExceptions = {
    // Rings hardly larger than a wide line have less ink, and the oracle's rings are not
    // simplified.
    {"Coincident", "outline of 3 px", {1, 0.0008}},
};

void look_at_all(HeldToTruth& held, const TrueClasses& classes) {
  for (const TileName tile : kTiles) held.look_at(tile, classes);
}

struct Kind {
  const char* name;
  std::vector<Shape> (*make)(std::mt19937&);
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class GeneratedOverlapsTest : public ::testing::TestWithParam<std::tuple<Kind, unsigned>> {};

TEST_P(GeneratedOverlapsTest, AreTrueInEveryStyle) {
  const auto& [kind, seed] = GetParam();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const ShapeFile file("shapes", kind.make(random));
  const TrueLayer layer = read_layer(file.path(), "kind");
  Program off({file.path()}, CoverageMode::off);
  Program automatic({file.path()}, CoverageMode::automatic);
  Program on({file.path()}, CoverageMode::on);  // in one graph, with shared faces
  HeldToTruth held({{"shapes"},
                    {&layer},
                    {{"coverage off", &off}, {"coverage auto", &automatic}, {"coverage on", &on}}});
  look_at_all(held, classes_of(layer, "kind"));
  expect_true(held, kind.name, kExceptions);
}

TEST_P(GeneratedOverlapsTest, AreTrueAsTwoLayers) {
  const auto& [kind, seed] = GetParam();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  // Every other shape is in the upper layer, so the layers' shapes overlap and lie side by side.
  std::vector<Shape> lower;
  std::vector<Shape> upper;
  for (const Shape& shape : kind.make(random)) {
    (random() % 2 == 0 ? lower : upper).push_back(shape);
  }
  const ShapeFile lower_file("lower", lower);
  const ShapeFile upper_file("upper", upper);
  const TrueLayer lower_layer = read_layer(lower_file.path(), "kind");
  const TrueLayer upper_layer = read_layer(upper_file.path(), "kind");
  const std::vector<std::string> files = {lower_file.path(), upper_file.path()};
  Program off(files, CoverageMode::off);
  Program automatic(files, CoverageMode::automatic);
  HeldToTruth held({{"lower", "upper"},
                    {&lower_layer, &upper_layer},
                    {{"coverage off", &off}, {"coverage auto", &automatic}}});
  look_at_all(held, {});
  expect_true(held, kind.name, kExceptions);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, GeneratedOverlapsTest,
    ::testing::Combine(::testing::Values(Kind{"StarsOverEachOther", stars_over_each_other},
                                         Kind{"Nested", nested}, Kind{"Neighbours", neighbours},
                                         Kind{"Coincident", coincident},
                                         Kind{"StarsOverNeighbours", stars_over_neighbours}),
                       ::testing::Values(1u, 2u)),
    [](const auto& test) {
      return std::string(std::get<0>(test.param).name) + std::to_string(std::get<1>(test.param));
    });

}  // namespace
}  // namespace trapeze::oracle
