// Pictures of polygons with shared borders, requested over HTTP: no gap at any tolerance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"
#include "render/picture/png.h"
#include "server/service/site.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using testing::kPixel;
using testing::point_at;

constexpr int kColumns = 8;
constexpr double kSide = 24;  // pixels
constexpr double kFrom = 32;  // where the plots begin, in columns and rows
constexpr double kTo = kFrom + kColumns * kSide;
constexpr std::array<const char*, 3> kPlotKinds = {"a", "b", "c"};

/// The borders between plots, each random but generated only once; the outer borders are straight.
class Plots {
 public:
  /// The border from one corner to the next, without its last point.
  std::vector<Point> border(int x, int y, int dx, int dy) {
    const bool is_outer = dx != 0 ? y == 0 || y == kColumns : x == 0 || x == kColumns;
    std::vector<Point>& points = borders_[{x, y, dx, dy}];
    if (!points.empty()) return points;
    std::uniform_real_distribution<double> off(-2.5, 2.5);
    constexpr int kPieces = 30;
    for (int i = 0; i < kPieces; ++i) {
      const double share = static_cast<double>(i) / kPieces;
      const double shift = is_outer || i == 0 ? 0 : off(random_);
      points.push_back(point_at(kFrom + (x + share * dx) * kSide + (dx == 0 ? shift : 0),
                                kFrom + (y + share * dy) * kSide + (dy == 0 ? shift : 0)));
    }
    return points;
  }

  Rings plot(int x, int y) {
    std::vector<Point> ring;
    const auto add = [&](std::vector<Point> points, Point end, bool forward) {
      points.push_back(end);
      if (!forward) std::reverse(points.begin(), points.end());
      ring.insert(ring.end(), points.begin(), points.end() - 1);
    };
    const auto corner = [](int cx, int cy) {
      return point_at(kFrom + cx * kSide, kFrom + cy * kSide);
    };
    add(border(x, y, 1, 0), corner(x + 1, y), true);
    add(border(x + 1, y, 0, 1), corner(x + 1, y + 1), true);
    add(border(x, y + 1, 1, 0), corner(x + 1, y + 1), false);
    add(border(x, y, 0, 1), corner(x, y + 1), false);
    Rings rings;
    rings.add(ring);
    return rings;
  }

 private:
  std::mt19937 random_{7};
  std::map<std::array<int, 4>, std::vector<Point>> borders_;
};

/// A square of `count` x `count` squares, each too small to see, inside a plot from which it is cut
/// out.
void add_crumbs(int count, double side, Point from, Rings& around, std::vector<Rings>& features) {
  const auto step = static_cast<std::int32_t>(side * kPixel);
  std::vector<Point> hole;
  const auto corner = [&](int x, int y) { return Point{from.x + x * step, from.y + y * step}; };
  for (int i = 0; i < count; ++i) hole.push_back(corner(i, 0));
  for (int i = 0; i < count; ++i) hole.push_back(corner(count, i));
  for (int i = count; i > 0; --i) hole.push_back(corner(i, count));
  for (int i = count; i > 0; --i) hole.push_back(corner(0, i));
  around.add(hole);
  for (int y = 0; y < count; ++y) {
    for (int x = 0; x < count; ++x) {
      Rings rings;
      rings.add(std::vector<Point>{corner(x, y), corner(x + 1, y), corner(x + 1, y + 1),
                                   corner(x, y + 1)});
      features.push_back(rings);
    }
  }
}

std::vector<Rings> plots_and_crumbs() {
  Plots plots;
  std::vector<Rings> features;
  for (int y = 0; y < kColumns; ++y) {
    for (int x = 0; x < kColumns; ++x) features.push_back(plots.plot(x, y));
  }
  Rings around = features[18];
  add_crumbs(12, 0.37, point_at(kFrom + 2.3 * kSide, kFrom + 2.3 * kSide), around, features);
  features[18] = around;
  return features;
}

ServedLayer layer_of_plots(const std::string& name, CoverageMode coverage) {
  LayerOptions options;
  options.coverage = coverage;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  FeatureTable table(std::vector<Field>{{"kind", FieldType::text}});
  std::vector<Rings> features = plots_and_crumbs();
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const std::array<Value, 1> values = {std::string_view(kPlotKinds[i % kPlotKinds.size()])};
    rows.push_back(table.append(static_cast<std::int64_t>(i), values));
    rings.push_back(&features[i]);
    if (coverage == CoverageMode::off) builders.front().add(rows.back(), features[i]);
  }
  if (coverage != CoverageMode::off) {
    EXPECT_TRUE(builders.front().add_coverage(rows, rings).apart.empty());
  }
  ServedLayer served;
  served.config.name = name;
  served.config.title = name;
  served.config.style = testing::style_of("fill=808080&fill-opacity=1");
  served.layer = LayerBuilder::join(builders, std::move(table));
  served.revision = revision_of(*served.layer);
  return served;
}

class CoveragePicturesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<ServedLayer> layers;
    layers.push_back(layer_of_plots("plots", CoverageMode::automatic));
    layers.push_back(layer_of_plots("apart", CoverageMode::off));
    site_.data().set(std::make_shared<const Dataset>(std::move(layers)));
  }

  Picture tile(const std::string& layer, const std::string& name, const std::string& query) {
    const std::string target = "/tiles/" + layer + "/" + name + ".png?" + query;
    return testing::picture_of(site_, target);
  }

  /// The least and the greatest alpha of the plots' pixels in the tile of zoom 0, without `corners`
  /// columns and rows at each of their outer corners.
  std::pair<int, int> alpha(const std::string& layer, const std::string& query, int corners = 0) {
    const Picture picture = tile(layer, "0/0/0", query);
    std::pair<int, int> range{255, 0};
    for (int row = static_cast<int>(kFrom); row < static_cast<int>(kTo); ++row) {
      for (int column = static_cast<int>(kFrom); column < static_cast<int>(kTo); ++column) {
        const auto is_at_corner = [corners](int at) {
          return at < kFrom + corners || at >= kTo - corners;
        };
        if (is_at_corner(column) && is_at_corner(row)) continue;
        const int a = picture.at(column, row).a;
        range = {std::min(range.first, a), std::max(range.second, a)};
      }
    }
    return range;
  }

  testing::SampleSite site_{false};
};

constexpr std::pair kOpaque{255, 255};
const std::string kByKind = "color-by=kind&classes=a:red,b:lime,c:blue&fill-opacity=1";

TEST_F(CoveragePicturesTest, OneColourIsOpaqueAtEveryTolerance) {
  for (const char* simplify : {"0", "0.25", "0.7", "1.3", "2", "3.9"}) {
    EXPECT_EQ(alpha("plots", std::string("simplify=") + simplify), kOpaque) << simplify;
  }
  EXPECT_LT(alpha("apart", "simplify=2").first, 100) << "there was nothing to show";
}

TEST_F(CoveragePicturesTest, ClassesMixToOpaqueColours) {
  for (const char* simplify : {"0", "0.25", "0.7", "1.3", "2"}) {
    EXPECT_EQ(alpha("plots", kByKind + "&simplify=" + simplify), kOpaque) << simplify;
  }
}

TEST_F(CoveragePicturesTest, RoundedCornersLeaveNoGap) {
  for (const char* smooth : {"0.5", "3", "64"}) {
    for (const char* simplify : {"0", "0.7", "2"}) {
      const std::string query = std::string("&smooth=") + smooth + "&simplify=" + simplify;
      EXPECT_EQ(alpha("plots", "fill=teal" + query, 12), kOpaque) << query;
      EXPECT_EQ(alpha("plots", kByKind + query, 12), kOpaque) << query;
    }
  }
  EXPECT_NE(tile("plots", "0/0/0", kByKind + "&smooth=3").pixels,
            tile("plots", "0/0/0", kByKind).pixels);
}

TEST_F(CoveragePicturesTest, CrumbsKeepTheirColours) {
  // Twelve rows of twelve, in three kinds by turns: each kind covers about a third of every pixel.
  const Picture picture = tile("plots", "0/0/0", kByKind + "&simplify=0.5");
  const int from = static_cast<int>(kFrom + 2.3 * kSide) + 1;
  std::array<int, 3> sum{};
  for (int row = from; row < from + 3; ++row) {
    for (int column = from; column < from + 3; ++column) {
      const Rgba colour = picture.at(column, row);
      EXPECT_EQ(colour.a, 255);
      sum[0] += colour.r;
      sum[1] += colour.g;
      sum[2] += colour.b;
    }
  }
  for (const int one : sum) EXPECT_NEAR(one / 9, 85, 40);
}

TEST_F(CoveragePicturesTest, OpacityIsTheSameEverywhere) {
  for (const std::string& query :
       {std::string("fill-opacity=0.5"), std::string("opacity=0.5"), kByKind + "&opacity=0.5"}) {
    const auto [least, greatest] = alpha("plots", query + "&simplify=1.3");
    EXPECT_GE(least, 127) << query;
    EXPECT_LE(greatest, 128) << query;
  }
}

TEST_F(CoveragePicturesTest, DashesOfASharedBorderAreDrawnOnce) {
  // Dashes drawn from both sides would fill each other's gaps.
  const auto dark_pixels = [this](const std::string& dashes) {
    const Picture picture =
        tile("plots", "0/0/0", "fill-opacity=0&stroke=000000&stroke-width=2&simplify=2" + dashes);
    std::size_t dark = 0;
    for (int row = 0; row < 256; ++row) {
      for (int column = 0; column < 256; ++column) dark += picture.at(column, row).a > 127;
    }
    return static_cast<double>(dark);
  };
  EXPECT_NEAR(dark_pixels("&stroke-dasharray=4,4") / dark_pixels(""), 0.5, 0.12);
}

bool is_dark(Rgba colour) {
  return colour.a == 255 && colour.r < 64 && colour.g < 64 && colour.b < 64;
}

TEST_F(CoveragePicturesTest, JunctionsAreMarkedAsLongAsThereAreAny) {
  const Picture picture = tile("plots", "0/0/0", "fill=white&debug=junctions&simplify=0.5");
  const Picture apart = tile("apart", "0/0/0", "fill=white&debug=junctions&simplify=0.5");
  for (int y = 0; y <= kColumns; ++y) {
    for (int x = 0; x <= kColumns; ++x) {
      const int column = static_cast<int>(kFrom + x * kSide);
      const int row = static_cast<int>(kFrom + y * kSide);
      const bool is_corner_of_all = (x == 0 || x == kColumns) && (y == 0 || y == kColumns);
      EXPECT_EQ(is_dark(picture.at(column, row)), !is_corner_of_all) << x << ", " << y;
    }
  }
  // Borders that begin at the same corner may cross near it.
  const auto is_near_corner = [](int at) {
    return std::abs(std::remainder(at + 0.5 - kFrom, kSide)) < 6;
  };
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      const bool is_of_crumbs = std::min(row, column) > kFrom + 2.1 * kSide &&
                                std::max(row, column) < kFrom + 2.7 * kSide;
      if (is_of_crumbs || (is_near_corner(row) && is_near_corner(column))) continue;
      ASSERT_FALSE(is_dark(picture.at(column, row))) << column << ", " << row;
    }
  }
  EXPECT_EQ(std::ranges::count_if(apart.pixels, is_dark), 0) << "they know nothing of each other";
  const Picture coarse = tile("plots", "0/0/0", "fill=white&debug=junctions&simplify=64");
  EXPECT_EQ(std::ranges::count_if(coarse.pixels, is_dark), 0) << "only one is left of the plots";
}

TEST_F(CoveragePicturesTest, EveryFeatureHasItsTintInAllTiles) {
  const Picture whole = tile("plots", "0/0/0@2x", "debug=faces&simplify=2");
  const Picture part = tile("plots", "1/0/0", "debug=faces&simplify=2");
  std::set<std::string> tints;
  for (int y = 0; y < kColumns / 2; ++y) {
    for (int x = 0; x < kColumns / 2; ++x) {
      const int column = static_cast<int>(2 * (kFrom + (x + 0.2) * kSide));
      const int row = static_cast<int>(2 * (kFrom + (y + 0.2) * kSide));
      EXPECT_EQ(part.at(column, row), whole.at(column, row));
      tints.insert(to_hex(part.at(column, row)));
    }
  }
  EXPECT_EQ(tints.size(), kColumns * kColumns / 4u);
  for (int row = static_cast<int>(2 * kFrom); row < 256; ++row) {
    for (int column = static_cast<int>(2 * kFrom); column < 256; ++column) {
      ASSERT_EQ(part.at(column, row).a, 255) << column << ", " << row;
    }
  }
}

/// The same look in tiles of zoom 1, and in a tile of zoom 0 and scale 2.
struct Look {
  const char* of_parts;
  const char* of_whole;
};
class NeighbouringTilesTest : public CoveragePicturesTest,
                              public ::testing::WithParamInterface<Look> {};

INSTANTIATE_TEST_SUITE_P(Looks, NeighbouringTilesTest,
                         ::testing::Values(Look{"", ""}, Look{"&smooth=10", "&smooth=5"},
                                           Look{"&smooth=10&stroke=black&stroke-width=2",
                                                "&smooth=5&stroke=black&stroke-width=1"}));

TEST_P(NeighbouringTilesTest, Agree) {
  // With bounded quality, small fractions of a pixel may get other colours in each tile.
  const std::string common = kByKind + "&simplify=1.3&quality=exact";
  const std::string query = common + GetParam().of_parts;
  const Picture whole = tile("plots", "0/0/0@2x", common + GetParam().of_whole);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) {
      const Picture part = tile("plots", "1/" + std::to_string(x) + "/" + std::to_string(y), query);
      for (int row = 0; row < 256; ++row) {
        for (int column = 0; column < 256; ++column) {
          const Rgba one = part.at(column, row);
          const Rgba other = whole.at(256 * x + column, 256 * y + row);
          ASSERT_EQ(one.a, other.a) << x << "/" << y << " " << column << " " << row;
          ASSERT_NEAR(one.r, other.r, 2);
          ASSERT_NEAR(one.g, other.g, 2);
          ASSERT_NEAR(one.b, other.b, 2);
        }
      }
    }
  }
}

}  // namespace
}  // namespace trapeze
