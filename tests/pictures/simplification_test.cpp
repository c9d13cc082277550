// The simplification of tiles is invisible: they are indistinguishable from the truth by eye, and
// have neither holes nor spikes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "render/software/software_renderer.h"
#include "tests/pictures/real_layers.h"

namespace trapeze::testing {
namespace {

constexpr int kFirstDetailedZoom = 8;
constexpr int kLastZoom = 18;
constexpr int kTilesPerZoom = 24;

constexpr int kPlainlyDifferent = 64;  // 255ths

/// How far the pictures of a zoom, taken together, may be from the truth.
struct Bounds {
  double mean;   // absolute difference, in 255ths
  double share;  // of plainly different pixels
};
constexpr Bounds kDetailed{1.0, 0.0005};
// The means are lower here, at most 0.6. However, where neighbours share borders that are
// simplified separately, small gaps open: with counties of two pixels 0.1 % of all pixels are off.
constexpr Bounds kOverview{0.8, 0.0012};
// The truth is sampled too, so even unsimplified layers are a little off.
constexpr Bounds kUntouched{0.25, 0.0};

/// How far pictures are from the truth.
struct Distance {
  std::size_t pixels = 0;
  std::uint64_t sum = 0;
  std::size_t plainly_different = 0;
  int worst = 0;
  std::string worst_tile;
  std::size_t holes_and_spikes = 0;

  double mean() const { return static_cast<double>(sum) / static_cast<double>(pixels); }
  double share() const {
    return static_cast<double>(plainly_different) / static_cast<double>(pixels);
  }
};

int apart(const Mask& truth, const Mask& drawn, int column, int row) {
  return std::abs(truth.at(column, row) - drawn.at(column, row));
}

/// A pixel that is full in one picture and less than half full in the other, or empty and more than
/// half full, while all eight pixels around it are similar.
bool is_hole_or_spike(const Mask& truth, const Mask& drawn, int column, int row) {
  const int was = truth.at(column, row);
  const int is = drawn.at(column, row);
  if (!(was > 250 && is < 128) && !(was < 5 && is > 128)) return false;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, truth.height() - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, truth.width() - 1); ++x) {
      const bool is_around = x != column || y != row;
      if (is_around && apart(truth, drawn, x, y) > kPlainlyDifferent) return false;
    }
  }
  return true;
}

void add_tile(const Mask& truth, const Mask& drawn, const TileId& tile, Distance& distance) {
  for (int row = 0; row < truth.height(); ++row) {
    for (int column = 0; column < truth.width(); ++column) {
      const int difference = apart(truth, drawn, column, row);
      distance.sum += static_cast<std::uint64_t>(difference);
      ++distance.pixels;
      if (difference > distance.worst) {
        distance.worst = difference;
        distance.worst_tile = text_of(tile);
      }
      if (difference <= kPlainlyDifferent) continue;
      ++distance.plainly_different;
      distance.holes_and_spikes += is_hole_or_spike(truth, drawn, column, row) ? 1 : 0;
    }
  }
}

class SimplificationTest : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    real_ = real_layer(GetParam());
    if (real_ == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of .fgb files";
  }

  /// For the tiles of one zoom, drawn with the selection of `select`; prints a line of the table.
  template <class Select>
  Distance measure(int zoom, const char* what, const Select& select) {
    Distance distance;
    Mask drawn;
    std::vector<TrapezoidRange> ranges;
    for (const TileId& tile : tiles_around_vertices(*real_, zoom, kTilesPerZoom, 3)) {
      const View view = View::of_tile(tile);
      real_->layer->select(select(view), ranges);
      software_.draw(real_->layer->mesh(), ranges, view, drawn);
      add_tile(real_->outlines.draw(view), drawn, tile, distance);
    }
    std::printf("%-20s zoom %2d %-11s mean %6.3f/255, over 64: %8.5f %%, worst %3d in %s\n",
                GetParam().c_str(), zoom, what, distance.mean(), 100 * distance.share(),
                distance.worst, distance.worst_tile.c_str());
    return distance;
  }

  static void expect_within(const Bounds& bounds, const Distance& distance, int zoom) {
    EXPECT_LE(distance.mean(), bounds.mean) << "zoom " << zoom;
    EXPECT_LE(distance.share(), bounds.share) << "zoom " << zoom;
    EXPECT_EQ(distance.holes_and_spikes, 0u) << "zoom " << zoom;
  }

  const RealLayer* real_ = nullptr;
  SoftwareRenderer software_;
};

TEST_P(SimplificationTest, CannotBeSeenAtZoom8AndAbove) {
  for (int zoom = kFirstDetailedZoom; zoom <= kLastZoom; ++zoom) {
    expect_within(kDetailed, measure(zoom, "simplified", default_selection), zoom);
  }
}

TEST_P(SimplificationTest, CanHardlyBeSeenBelowZoom8) {
  for (int zoom = 0; zoom < kFirstDetailedZoom; ++zoom) {
    expect_within(kOverview, measure(zoom, "simplified", default_selection), zoom);
  }
}

TEST_P(SimplificationTest, IsAllThatPartsPicturesFromTheTruth) {
  const auto untouched = [](const View& view) {
    return Layer::Selection{view.box(), 0, 0, SmallPolygons::dust};
  };
  for (int zoom = 0; zoom <= kLastZoom; ++zoom) {
    expect_within(kUntouched, measure(zoom, "untouched", untouched), zoom);
  }
}

INSTANTIATE_TEST_SUITE_P(Layers, SimplificationTest, ::testing::ValuesIn(real_layer_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace trapeze::testing
