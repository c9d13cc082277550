// Layers of one picture that share a border: land and water along a coast.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <random>

#include "core/layer/layer_builder.h"
#include "render/picture/png.h"
#include "server/service/site.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/tile_and_children.h"

namespace trapeze {
namespace {

using testing::cell;

/// From north to south through the tile of zoom 0, as rough at every scale as real coasts.
std::vector<Point> coast() {
  std::mt19937 random(5);
  std::vector<double> places{120, 140};
  for (double roughness = 24; roughness > 1e-3; roughness /= 1.9) {
    std::vector<double> finer;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const double share = static_cast<double>(random() % 1000) / 500 - 1;
      finer.push_back(places[i]);
      finer.push_back((places[i] + places[i + 1]) / 2 + roughness * share);
    }
    finer.push_back(places.back());
    places.swap(finer);
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(places.size() - 1);
    points.push_back({cell(places[i]), cell(20.3 + share * 215.4)});
  }
  return points;
}

ServedLayer layer_of_kinds(const std::string& name, std::vector<Rings> polygons) {
  FeatureTable features({{"kind", FieldType::text}});
  std::vector<LayerBuilder> builders(1);
  for (Rings& rings : polygons) {
    const std::vector<Value> values = {std::string_view(features.size() % 2 == 0 ? "a" : "b")};
    const auto row = features.append(static_cast<std::int64_t>(features.size()) + 1, values);
    builders.front().add(row, rings);
  }
  ServedLayer served;
  served.config.name = name;
  served.config.title = name;
  served.config.style = testing::style_of("fill=808080");
  served.layer = LayerBuilder::join(builders, std::move(features));
  served.revision = revision_of(*served.layer);
  return served;
}

Rings ring_of(std::vector<Point> points, double x) {
  points.push_back({cell(x), points.back().y});
  points.push_back({cell(x), points.front().y});
  Rings rings;
  rings.add(points);
  return rings;
}

class MeetingLayersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<ServedLayer> layers;
    layers.push_back(layer_of_kinds("land", {ring_of(coast(), 20.3)}));
    layers.push_back(layer_of_kinds("water", {ring_of(coast(), 235.6)}));
    layers.push_back(layer_of_kinds("park", {ring_of(coast(), 90)}));
    site_.data().set(std::make_shared<const Dataset>(std::move(layers)));
  }

  Picture tile(const std::string& layers, const std::string& place, const std::string& query) {
    const std::string target =
        fmt::format("/tiles/{}/{}.png?quality=exact&{}", layers, place, query);
    return testing::picture_of(site_, target);
  }

  /// The number of pixels inside both layers together with less than that opacity.
  static int count_pale(const Picture& picture, int opacity) {
    int pale = 0;
    for (int row = 21; row < 235; ++row) {
      for (int column = 21; column < 235; ++column) {
        if (picture.at(column, row).a < opacity) ++pale;
      }
    }
    return pale;
  }

  testing::SampleSite site_{false};
};

TEST_F(MeetingLayersTest, NoBackgroundShowsAlongACoast) {
  for (const std::string layers : {"land,water", "water,land"}) {
    const auto pale = [&](const std::string& query, int opacity) {
      return count_pale(tile(layers, "0/0/0", query), opacity);
    };
    EXPECT_EQ(pale("land.fill=red&water.fill=blue&simplify=0", 254), 0) << layers;
    // Each layer is simplified by itself and so has a border of its own.
    EXPECT_LE(pale("land.fill=red&water.fill=blue", 235), 2) << layers;
    EXPECT_EQ(pale("simplify=0&land.color-by=kind&land.classes=a:red,b:lime&water.fill=blue", 254),
              0)
        << layers;
    EXPECT_EQ(pale("simplify=0&land.pattern=hatch&water.pattern=dots", 254), 0) << layers;
    EXPECT_EQ(pale("simplify=0&stroke=black&opacity=0.99", 250), 0) << layers;
  }
}

TEST_F(MeetingLayersTest, HalfOpaqueLayersAreHalfOpaqueAlongACoast) {
  const Picture picture =
      tile("land,water", "0/0/0", "simplify=0&land.opacity=0.5&water.fill-opacity=0.5");
  for (int row = 21; row < 235; ++row) {
    for (int column = 21; column < 235; ++column) {
      ASSERT_NEAR(picture.at(column, row).a, 128, 2) << column << ' ' << row;
    }
  }
}

TEST_F(MeetingLayersTest, ALayerUpToTheEdgeOfTheOneBelowShowsNoRimOfIt) {
  const Picture both = tile("land,park", "0/0/0", "simplify=0&land.fill=red&park.fill=lime");
  const Picture park = tile("park", "0/0/0", "simplify=0&park.fill=lime");
  // East of the western border of the park, the land ends at the border of the park.
  for (int row = 22; row < 234; ++row) {
    for (int column = 92; column < 256; ++column) {
      const Rgba colour = both.at(column, row);
      ASSERT_NEAR(colour.a, park.at(column, row).a, 5) << column << ' ' << row;
      if (colour.a > 8) {
        ASSERT_LE(colour.r, 255 * 3 / colour.a) << column << ' ' << row;
      }
    }
  }
}

TEST_F(MeetingLayersTest, ATileAtTwiceTheScaleIsItsFourChildren) {
  const std::string style = "land.fill=red&water.fill=blue";
  testing::expect_children_are_alike(
      tile("land,water", "1/1/0@2x", style),
      {tile("land,water", "2/2/0", style), tile("land,water", "2/3/0", style),
       tile("land,water", "2/2/1", style), tile("land,water", "2/3/1", style)});
}

}  // namespace
}  // namespace trapeze
