// Pictures with rounded corners, requested over HTTP, compared with sampled parabolas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "server/service/site.h"
#include "tests/core/shapes/layers.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/same_by_gl.h"

namespace trapeze {
namespace {

using testing::Place;
using testing::point_at;
using testing::Ring;

/// Land cover as derived from a raster, with steps and slopes and with a hole.
const std::vector<Ring> kStairs = {
    {{40, 40},
     {80, 40},
     {80, 52},
     {104, 52},
     {104, 70},
     {130, 70},
     {130, 130},
     {190, 160},
     {180, 200},
     {120, 210},
     {60, 180},
     {60, 120},
     {40, 120}},
    {{80, 90}, {100, 90}, {100, 110}, {110, 110}, {110, 140}, {80, 140}}};
const Ring kEast = {{200, 40}, {256, 40}, {256, 120}, {230, 100}};  // cut at the antimeridian

Place between(Place a, Place b, double share) {
  return {a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share};
}

/// The ring with every corner replaced by a parabola of many chords.
Ring rounded(const Ring& ring, double radius) {
  constexpr int kChords = 64;
  Ring result;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Place tip = ring[i];
    const auto end_towards = [&](Place other) {
      const double length = std::hypot(other.x - tip.x, other.y - tip.y);
      return between(tip, other, std::min(0.5, radius / length));
    };
    const Place from = end_towards(ring[(i + ring.size() - 1) % ring.size()]);
    const Place to = end_towards(ring[(i + 1) % ring.size()]);
    for (int k = 0; k <= kChords; ++k) {
      const double share = static_cast<double>(k) / kChords;
      result.push_back(between(between(from, tip, share), between(tip, to, share), share));
    }
  }
  return result;
}

/// Alpha by pixel of the tile, in 255ths: in each row, the stretches between every odd crossing and
/// the next one, along 16 lines.
std::vector<double> true_alphas(const std::vector<Ring>& rings) {
  constexpr int kLines = 16;
  std::vector<double> alphas(256 * 256);
  for (int line = 0; line < 256 * kLines; ++line) {
    const double y = (line + 0.5) / kLines;
    std::vector<double> crossings;
    for (const Ring& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Place a = ring[i];
        const Place b = ring[(i + 1) % ring.size()];
        if ((a.y > y) == (b.y > y)) continue;
        crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      }
    }
    std::ranges::sort(crossings);
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      for (int column = static_cast<int>(crossings[i]); column < crossings[i + 1]; ++column) {
        const double from = std::max<double>(column, crossings[i]);
        const double to = std::min<double>(column + 1, crossings[i + 1]);
        alphas[static_cast<std::size_t>(line / kLines * 256 + column)] +=
            255 * (to - from) / kLines;
      }
    }
  }
  return alphas;
}

class SmoothPicturesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<ServedLayer> layers;
    layers.push_back(layer("stairs", {rings_of(kStairs)}));
    layers.push_back(layer("east", {rings_of({kEast})}));
    // The second overlaps the first, so the first keeps its corners.
    layers.push_back(
        layer("over", {rings_of(kStairs), rings_of({{{50, 50}, {70, 50}, {60, 70}}})}));
    dataset_ = std::make_shared<const Dataset>(std::move(layers));
    site_.data().set(dataset_);
  }

  static Rings rings_of(const std::vector<Ring>& shape) {
    Rings rings;
    for (const Ring& ring : shape) {
      std::vector<Point> points;
      for (const Place p : ring) points.push_back(point_at(p.x, p.y));
      rings.add(points);
    }
    return rings;
  }

  static ServedLayer layer(const std::string& name, std::vector<Rings> features) {
    ServedLayer served;
    served.config.name = name;
    served.config.title = name;
    served.config.style = testing::style_of("fill=808080&fill-opacity=1");
    served.layer = layer_of(std::move(features));
    served.revision = revision_of(*served.layer);
    return served;
  }

  Picture tile(const std::string& layer_and_tile, const std::string& query) {
    return testing::picture_of(site_, "/tiles/" + layer_and_tile + ".png?quality=exact&" + query);
  }

  std::string etag(const std::string& layer_and_tile, const std::string& query) {
    return std::string(site_.get("/tiles/" + layer_and_tile + ".png?" + query).header("ETag"));
  }

  std::shared_ptr<const Dataset> dataset_;
  testing::SampleSite site_{false};
};

TEST_F(SmoothPicturesTest, AreasAreThoseOfPolygonsWithParabolasForCorners) {
  for (const double radius : {4.0, 9.0, 64.0}) {
    const std::vector<Ring> truth = {rounded(kStairs[0], radius), rounded(kStairs[1], radius)};
    const Picture picture =
        tile("stairs/0/0/0", "simplify=0&smooth=" + std::to_string(static_cast<int>(radius)));
    const std::vector<double> alphas = true_alphas(truth);
    double sum = 0;
    double worst = 0;
    int edges = 0;
    for (std::size_t i = 0; i < alphas.size(); ++i) {
      const double off = std::abs(picture.pixels[i].a - alphas[i]);
      edges += alphas[i] > 1 && alphas[i] < 254 ? 1 : 0;
      sum += off;
      worst = std::max(worst, off);
    }
    EXPECT_GT(edges, 300);
    // Chords are off by a 25th of a pixel at most.
    EXPECT_LT(worst, 20) << radius;
    EXPECT_LT(sum / edges, 5) << radius;
  }
}

TEST_F(SmoothPicturesTest, NothingIsRoundedWhereAPolygonWasCutOff) {
  const Picture sharp = tile("east/0/0/0", "simplify=0");
  const Picture smooth = tile("east/0/0/0", "simplify=0&smooth=20");
  for (int row = 30; row < 125; ++row) EXPECT_EQ(smooth.at(255, row), sharp.at(255, row)) << row;
  EXPECT_NE(smooth.at(200, 40), sharp.at(200, 40));
}

TEST_F(SmoothPicturesTest, PolygonsThatLieOverEachOtherStaySharp) {
  EXPECT_TRUE(tile("over/0/0/0", "simplify=0&smooth=9").pixels ==
              tile("over/0/0/0", "simplify=0").pixels);
  EXPECT_NE(tile("stairs/0/0/0", "simplify=0&smooth=9").pixels,
            tile("stairs/0/0/0", "simplify=0").pixels);
}

TEST_F(SmoothPicturesTest, AnOutlineFollowsTheCurve) {
  const Picture picture =
      tile("stairs/0/0/0", "simplify=0&smooth=20&fill-opacity=0&stroke=000&stroke-width=3");
  const Ring curve = rounded(kStairs[0], 20);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Place p = curve[i];
    EXPECT_GT(picture.at(static_cast<int>(p.x), static_cast<int>(p.y)).a, 180) << p.x << ' ' << p.y;
  }
  EXPECT_EQ(picture.at(41, 41).a, 0) << "the corner is drawn";
}

TEST_F(SmoothPicturesTest, DashesAreAsLongAsWithSharpCorners) {
  const auto ink = [this](const std::string& more) {
    const Picture picture =
        tile("stairs/0/0/0", "simplify=0&fill-opacity=0&stroke=000&stroke-width=2" + more);
    double sum = 0;
    for (const Rgba pixel : picture.pixels) sum += pixel.a;
    return sum;
  };
  const std::string dashes = "&stroke-dasharray=5,5";
  EXPECT_NEAR(ink("&smooth=8" + dashes) / ink("&smooth=8"), ink(dashes) / ink(""), 0.03);
}

TEST_F(SmoothPicturesTest, TheTagOfATileTellsCornersThatAreSeenInIt) {
  EXPECT_NE(etag("stairs/0/0/0", "smooth=8"), etag("stairs/0/0/0", ""));
  EXPECT_EQ(etag("stairs/0/0/0", "smooth=0"), etag("stairs/0/0/0", ""));
  // Wholly inside the polygon, or on a straight edge.
  EXPECT_EQ(etag("stairs/5/13/19", "smooth=8"), etag("stairs/5/13/19", ""));
  EXPECT_EQ(etag("stairs/5/7/5", "smooth=8"), etag("stairs/5/7/5", ""));
}

TEST_F(SmoothPicturesTest, ACornerBesideATileReachesIntoIt) {
  // At zoom 4, the corner at 130, 70 is 32 pixels east of the tile 7/4.
  const Picture sharp = tile("stairs/4/7/4", "simplify=0");
  const Picture smooth = tile("stairs/4/7/4", "simplify=0&smooth=64");
  EXPECT_FALSE(sharp.pixels == smooth.pixels);
  const Picture whole = tile("stairs/3/3/2@2x", "simplify=0&smooth=32");
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      ASSERT_NEAR(smooth.at(column, row).a, whole.at(256 + column, row).a, 1);
    }
  }
}

TEST_F(SmoothPicturesTest, AreTheSameByGl) {
  for (const char* target : {"stairs/0/0/0.png?quality=exact&smooth=9&simplify=0",
                             "stairs/3/2/1.png?quality=exact&smooth=64&simplify=0"}) {
    testing::expect_same_by_gl(target, dataset_);
  }
}

TEST_F(SmoothPicturesTest, WrongNumbersAreProblems) {
  for (const char* value : {"-1", "65", "on", ""}) {
    const HttpResponse response = site_.get(std::string("/tiles/stairs/0/0/0.png?smooth=") + value);
    EXPECT_EQ(response.status, 400) << value;
    EXPECT_THAT(*response.body, ::testing::HasSubstr("a number from 0 to 64")) << value;
  }
}

}  // namespace
}  // namespace trapeze
