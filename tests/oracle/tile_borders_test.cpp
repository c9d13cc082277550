// Colours that are merged separately in each tile show no seam where tiles meet.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/oracle/program.h"

namespace trapeze::oracle {
namespace {

/// Layers of one place, and a tile of zoom 16 with many features.
struct BorderCase {
  std::vector<std::string> layers;
  TileName tile;
};

void PrintTo(const BorderCase& place, std::ostream* out) {
  *out << place.layers.front();
}

const std::vector<BorderCase> kPlaces = {
    {{"malta_landuse", "malta_natural", "malta_buildings"}, {16, 35408, 25758}},
    {{"melbourne_landuse", "melbourne_natural"}, {16, 59157, 40213}},
    {{"shenzhen_water", "shenzhen_buildings"}, {16, 53531, 28554}},
    {{"us_counties"}, {16, 17403, 26245}},
};
constexpr int kFirstBorderZoom = 7;
constexpr int kLastBorderZoom = 16;

/// Premultiplied, from 0 to 255.
double channel(Rgba colour, std::size_t i) {
  const std::array<std::uint8_t, 4> channels{colour.r, colour.g, colour.b, colour.a};
  return i == 3 ? colour.a : channels[i] * colour.a / 255.0;
}

/// How much more or less two pixels differ than in the exact picture, averaged over all channels.
class Steps {
 public:
  void add(Rgba one, Rgba other, Rgba exact_one, Rgba exact_other) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double error_of_one = channel(one, i) - channel(exact_one, i);
      const double error_of_other = channel(other, i) - channel(exact_other, i);
      sum_ += std::abs(error_of_one - error_of_other);
    }
    ++pairs_;
  }
  double mean() const { return pairs_ == 0 ? 0 : sum_ / 4 / pairs_; }

 private:
  double sum_ = 0;
  double pairs_ = 0;
};

struct Drawn {
  Picture bounded;
  Picture exact;
};

class TileBordersTest : public ::testing::TestWithParam<BorderCase> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    for (const std::string& layer : GetParam().layers) {
      files_.push_back(std::string(data) + "/" + layer + ".fgb");
    }
  }

  std::string style() const {
    const std::array<const char*, 3> kFills{"c8e0b0", "88b878c0", "a08070"};
    std::string style;
    for (std::size_t i = 0; i < GetParam().layers.size(); ++i) {
      const std::string& layer = GetParam().layers[i];
      style += layer + ".fill=" + kFills[i] + "&" + layer + ".stroke=604030&";
    }
    return style;
  }

  std::vector<std::string> files_;
};

TEST_P(TileBordersTest, AreNoPlaceOfMoreChange) {
  Program program(files_, CoverageMode::automatic);
  const auto draw = [&](TileName tile) {
    const std::string query = style();
    return Drawn{program.tile(GetParam().layers, tile, query),
                 program.tile(GetParam().layers, tile, query + "quality=exact")};
  };
  Steps across;
  Steps within;
  for (int zoom = kFirstBorderZoom; zoom <= kLastBorderZoom; ++zoom) {
    const unsigned up = static_cast<unsigned>(kLastBorderZoom - zoom);
    const TileName west{zoom, GetParam().tile.x >> up, GetParam().tile.y >> up};
    const Drawn left = draw(west);
    const Drawn right = draw({zoom, west.x + 1, west.y});
    const Drawn below = draw({zoom, west.x, west.y + 1});
    for (int i = 0; i < kPixels; ++i) {
      across.add(left.bounded.at(255, i), right.bounded.at(0, i), left.exact.at(255, i),
                 right.exact.at(0, i));
      across.add(left.bounded.at(i, 255), below.bounded.at(i, 0), left.exact.at(i, 255),
                 below.exact.at(i, 0));
      for (int k = 32; k < kPixels; k += 32) {
        within.add(left.bounded.at(k - 1, i), left.bounded.at(k, i), left.exact.at(k - 1, i),
                   left.exact.at(k, i));
        within.add(left.bounded.at(i, k - 1), left.bounded.at(i, k), left.exact.at(i, k - 1),
                   left.exact.at(i, k));
      }
    }
  }
  std::printf("%s: %.3f across, %.3f within\n", GetParam().layers.front().c_str(), across.mean(),
              within.mean());
  EXPECT_GT(within.mean(), 0) << "colours do become one";
  EXPECT_LE(across.mean(), 1.3 * within.mean() + 0.01);
}

INSTANTIATE_TEST_SUITE_P(Places, TileBordersTest, ::testing::ValuesIn(kPlaces),
                         [](const auto& test) { return test.param.layers.front(); });

}  // namespace
}  // namespace trapeze::oracle
