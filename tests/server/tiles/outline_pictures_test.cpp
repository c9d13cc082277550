// Pictures of outlines, requested over HTTP: outlines of small rings have the right darkness, and
// all outlines are the same in all tiles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "core/layer/layer_builder.h"
#include "render/picture/png.h"
#include "server/service/site.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/tile_and_children.h"

namespace trapeze {
namespace {

using testing::point_at;

/// A star around a place, with approximately this extent.
Rings star(double x, double y, double extent, double roughness, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(extent / 2 * (1 - roughness),
                                                extent / 2 * (1 + roughness));
  constexpr int kRays = 48;
  Rings rings;
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRays;
    const double r = radius(random);
    rings.points.push_back(point_at(x + r * std::cos(angle), y + r * std::sin(angle)));
  }
  rings.close_ring();
  return rings;
}

class OutlinePicturesTest : public ::testing::Test {
 protected:
  void serve(std::vector<Rings> features, CoverageMode coverage = CoverageMode::off) {
    LayerOptions options;
    options.coverage = coverage;
    std::vector<LayerBuilder> builders;
    builders.emplace_back(options);
    FeatureTable table(std::vector<Field>{});
    std::vector<std::uint32_t> rows;
    std::vector<const Rings*> rings;
    for (Rings& feature : features) {
      rows.push_back(table.append(static_cast<std::int64_t>(rows.size()), {}));
      rings.push_back(&feature);
      if (coverage == CoverageMode::off) builders.front().add(rows.back(), feature);
    }
    if (coverage != CoverageMode::off) {
      for (const std::uint32_t i : builders.front().add_coverage(rows, rings).apart) {
        builders.front().add(rows[i], features[i]);
      }
    }
    ServedLayer served;
    served.config.name = served.config.title = "rings";
    served.config.style = testing::style_of("fill=none&small=drop");
    served.layer = LayerBuilder::join(builders, std::move(table));
    served.revision = revision_of(*served.layer);
    std::vector<ServedLayer> layers;
    layers.push_back(std::move(served));
    site_.data().set(std::make_shared<const Dataset>(std::move(layers)));
  }

  Picture tile(const std::string& name, const std::string& query) {
    const std::string target = "/tiles/rings/" + name + ".png?" + query;
    return testing::picture_of(site_, target);
  }

  /// In pixels.
  static double ink_of(const Picture& picture) {
    double ink = 0;
    for (int row = 0; row < picture.height; ++row) {
      for (int column = 0; column < picture.width; ++column) ink += picture.at(column, row).a;
    }
    return ink / 255;
  }

  testing::SampleSite site_{false};
};

TEST_F(OutlinePicturesTest, InkOfARingGoesToNothingWithItsSize) {
  double before = 0;
  for (double extent = 0.6; extent < 12; extent *= 1.05) {
    serve({star(100.3, 100.4, extent, 0, 1)});
    const double ink = ink_of(tile("0/0/0", "stroke=000&stroke-width=1"));
    const double all = std::numbers::pi * extent;  // the ink of a line of one pixel
    if (extent > 4.3) {
      EXPECT_NEAR(ink / all, 1, 0.06) << extent;
    } else {
      EXPECT_LT(ink, 1.1 * all) << extent;
      EXPECT_LT(ink, 0.9 * extent * extent + 0.1) << "a dot would have three pixels: " << extent;
    }
    EXPECT_GE(ink, before - 0.05) << extent;
    EXPECT_LE(ink, 1.3 * before + 0.4) << "it does not jump: " << extent;
    before = ink;
  }
}

TEST_F(OutlinePicturesTest, ALargeOneIsWholeBesideASmallOne) {
  Rings large;
  large.points = {point_at(50, 50), point_at(50, 150), point_at(150, 150), point_at(150, 50)};
  large.close_ring();
  Rings small;
  small.points = {point_at(150, 80), point_at(150, 82), point_at(152, 82), point_at(152, 80)};
  small.close_ring();
  serve({large, small}, CoverageMode::on);
  const Picture picture = tile("0/0/0", "stroke=000&stroke-width=2");
  for (int row = 51; row < 149; ++row) EXPECT_EQ(picture.at(150, row).a, 255) << row;
}

/// Rings of all sizes around the corner of four tiles, and a large ring below others.
std::vector<Rings> rings_of_all_sizes() {
  std::vector<Rings> features = {star(128, 128, 90, 0.3, 1)};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(90, 166);
  std::uniform_real_distribution<double> extent(0.3, 5);
  for (unsigned i = 0; i < 150; ++i) {
    features.push_back(star(place(random), place(random), extent(random), 0.2, i));
  }
  return features;
}

TEST_F(OutlinePicturesTest, ATileAtTwiceTheScaleIsAsItsFourChildren) {
  serve(rings_of_all_sizes());
  constexpr std::array<std::pair<const char*, const char*>, 4> kStrokes = {
      {{"&stroke-width=1", "&stroke-width=2"},
       {"&stroke-width=1.5&stroke-linejoin=bevel", "&stroke-width=3&stroke-linejoin=bevel"},
       {"&stroke-width=1&stroke-dasharray=4,2", "&stroke-width=2&stroke-dasharray=8,4"},
       {"&stroke-width=2&stroke-linejoin=miter&stroke-dasharray=3,1,1,1",
        "&stroke-width=4&stroke-linejoin=miter&stroke-dasharray=6,2,2,2"}}};
  for (const auto& [of_parent, of_child] : kStrokes) {
    SCOPED_TRACE(of_parent);
    const Picture parent = tile("0/0/0@2x", std::string("stroke=000") + of_parent);
    EXPECT_GT(ink_of(parent), 500);
    const std::string query = std::string("stroke=000") + of_child;
    testing::expect_children_are_alike(parent, {tile("1/0/0", query), tile("1/1/0", query),
                                                tile("1/0/1", query), tile("1/1/1", query)});
  }
}

Rings polygon(std::vector<Point> points) {
  Rings rings;
  rings.points = std::move(points);
  rings.close_ring();
  return rings;
}

constexpr std::array<const char*, 3> kJoins = {"bevel", "miter", "round"};

/// Expects equal columns from the western edge to `end`.
void expect_alike_up_to(int end, const Picture& a, const Picture& b) {
  for (int row = 0; row < a.height; ++row) {
    for (int column = 0; column < end; ++column) {
      ASSERT_EQ(a.at(column, row), b.at(column, row)) << column << " " << row;
    }
  }
}

TEST_F(OutlinePicturesTest, CornersOfWhatLiesUnderOthersAreJoined) {
  serve({polygon({point_at(60, 60), point_at(60, 120), point_at(120, 120), point_at(120, 60)}),
         polygon({point_at(110, 80), point_at(110, 100), point_at(150, 100), point_at(150, 80)})});
  for (const std::string join : kJoins) {
    const std::string query = "fill=fff&stroke=000&stroke-width=12&stroke-linejoin=" + join;
    for (const auto& [name, end] : {std::pair("0/0/0", 100), {"WorldCRS84Quad/0/0/0", 100}}) {
      SCOPED_TRACE(join + name);
      const Picture alone = tile(name, query + "&ids=0");
      EXPECT_GT(ink_of(alone), 3000);
      expect_alike_up_to(end, tile(name, query), alone);
    }
  }
}

TEST_F(OutlinePicturesTest, CornersOfABorderThatLiesUnderOthersAreJoined) {
  serve({polygon({point_at(40, 40), point_at(40, 160), point_at(80, 160), point_at(60, 120),
                  point_at(90, 80), point_at(70, 40)}),
         polygon({point_at(70, 40), point_at(90, 80), point_at(60, 120), point_at(80, 160),
                  point_at(160, 160), point_at(160, 40)}),
         polygon({point_at(50, 150), point_at(50, 170), point_at(150, 170), point_at(150, 150)})},
        CoverageMode::automatic);
  for (const std::string join : kJoins) {
    SCOPED_TRACE(join);
    const std::string query = "fill=fff&stroke=000&stroke-width=10&stroke-linejoin=" + join;
    const Picture all = tile("0/0/0", query);
    const Picture without_what_lies_over = tile("0/0/0", query + "&ids=0,1");
    for (int row = 0; row < 135; ++row) {
      for (int column = 0; column < 256; ++column) {
        ASSERT_EQ(all.at(column, row), without_what_lies_over.at(column, row))
            << column << " " << row;
      }
    }
  }
}

// Whether a feature is cut, because another one lies over it, depends on the picture.
TEST_F(OutlinePicturesTest, JoinsWhereThreeMeetDoNotDependOnWhatLiesOverThemElsewhere) {
  const auto ring = [](std::initializer_list<Point> points) {
    Rings rings;
    rings.points = points;
    rings.close_ring();
    return rings;
  };
  const Point meeting = point_at(200, 100);
  serve(
      {ring({point_at(40, 100), meeting, point_at(190, 60), point_at(40, 60)}),
       ring({meeting, point_at(230, 80), point_at(190, 60)}),
       ring({point_at(40, 100), point_at(40, 140), point_at(230, 140), point_at(230, 80), meeting}),
       ring({point_at(60, 70), point_at(60, 90), point_at(100, 90), point_at(100, 70)})},
      CoverageMode::automatic);
  for (const std::string join : {"bevel", "miter"}) {
    SCOPED_TRACE(join);
    const std::string style = "fill=00000002&quality=exact&stroke=000&stroke-linejoin=" + join;
    const Picture parent = tile("0/0/0@2x", style + "&stroke-width=3");
    const std::string of_child = style + "&stroke-width=6";
    testing::expect_children_are_alike(parent, {tile("1/0/0", of_child), tile("1/1/0", of_child),
                                                tile("1/0/1", of_child), tile("1/1/1", of_child)});
  }
}

TEST_F(OutlinePicturesTest, CornersThatStaySharpAreJoined) {
  // The second is in the triangle where the inner corner of the first would be rounded.
  serve({polygon({point_at(60, 60), point_at(60, 120), point_at(90, 120), point_at(90, 90),
                  point_at(120, 90), point_at(120, 60)}),
         polygon({point_at(93, 93), point_at(93, 96), point_at(96, 93)})});
  const std::string query = "stroke=000&stroke-width=12&smooth=14&stroke-linejoin=";
  EXPECT_EQ(tile("0/0/0", query + "miter").at(84, 84).a, 255);
  EXPECT_EQ(tile("0/0/0", query + "round").at(84, 84).a, 0);
}

/// From the western edge of the world to the eastern one, down to a parallel in the south.
Rings cut_by_the_frame(double latitude) {
  const auto south = static_cast<std::int32_t>(std::lround(grid_from_lonlat({0, latitude}).y));
  Rings rings;
  const std::int32_t rounded = south - south / 10'000;
  rings.points = {{kGridMin, 0}, {kGridMin, south}, {0, rounded}, {kGridMax, south}, {kGridMax, 0}};
  rings.close_ring();
  return rings;
}

TEST_F(OutlinePicturesTest, NothingIsDrawnAlongTheEdgesOfTheWorld) {
  for (const std::string dashes : {"", "&stroke-dasharray=6,2"}) {
    serve({cut_by_the_frame(dashes.empty() ? -85.051 : -kMaxLatitude)});
    const Picture picture = tile("0/0/0", "stroke=000&stroke-width=6" + dashes);
    for (int i = 136; i < 256; ++i) {
      EXPECT_EQ(picture.at(0, i).a, 0) << i;
      EXPECT_EQ(picture.at(255, i).a, 0) << i;
      EXPECT_EQ(picture.at(i, 255).a, 0) << i;
    }
    EXPECT_NEAR(ink_of(picture) / (256 * 6), dashes.empty() ? 1 : 0.75, 0.03);
  }
  serve({cut_by_the_frame(-85)});
  EXPECT_GT(tile("0/0/0", "stroke=000&stroke-width=6").at(128, 255).a, 200) << "it ends there";
}

}  // namespace
}  // namespace trapeze
