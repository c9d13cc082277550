#include "core/layer/feature_stack.h"

#include <gmock/gmock.h>

#include <map>
#include <random>

#include "core/grid/cancellation.h"
#include "tests/core/shapes/layers.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// The visible parts of each feature of a layer: a sum of areas by row and share.
class SeenAreas {
 public:
  explicit SeenAreas(const std::vector<std::string>& texts) {
    std::vector<Rings> polygons;
    for (const std::string& text : texts) polygons.push_back(rings_from_text(text));
    layer_ = layer_of(std::move(polygons));
    for (std::uint32_t row = 0; row < texts.size(); ++row) paints_.push_back({row, 1, false});
  }

  FeatureStack::Paint& paint(std::uint32_t row) { return paints_[row]; }
  /// The number of trapezoids that the last areas() had to cut up.
  std::size_t cut_up() const { return cut_up_; }
  void set_narrowest(double cells) { narrowest_ = cells; }
  void cut_whole_features() { cuts_whole_features_ = true; }
  void set_plain() { is_plain_ = true; }
  void set_coarse() { is_fine_ = false; }

  std::map<std::pair<std::uint32_t, float>, double> areas(
      const Cancellation* cancellation = nullptr) {
    std::vector<TrapezoidRange> ranges;
    layer_->select({layer_->bounds(), 0, kLastLevel, SmallPolygons::drop}, ranges);
    std::map<std::pair<std::uint32_t, float>, double> areas;
    const MeshView& mesh = layer_->mesh();
    const auto add = [&](std::uint32_t row, float share, double top, double bottom,
                         std::uint32_t left, std::uint32_t right) {
      const double y = (top + bottom) / 2;
      areas[{row, share}] +=
          (EdgeLine(mesh, right).x_at(y) - EdgeLine(mesh, left).x_at(y)) * (bottom - top);
    };
    const auto add_whole = [&](std::uint32_t row, std::uint32_t i) {
      const MeshTrapezoid& t = mesh.trapezoids[i];
      const double top = mesh.vertices[t.top].y;
      const double bottom = mesh.vertices[t.bottom].y;
      if (top < bottom) add(row, 1, top, bottom, t.left, t.right);
    };
    FeatureStack stack;
    stack.begin(layer_->overlaps(), mesh, {narrowest_, cuts_whole_features_, is_plain_, is_fine_});
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      stack.note(layer_->feature_of(i), [this](std::uint32_t row) { return paints_[row]; });
    });
    stack.find_covers(cancellation);
    for_each_trapezoid(ranges,
                       [&](std::uint32_t i) { stack.note_place(layer_->feature_of(i), i); });
    stack.settle();
    cut_up_ = 0;
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      const std::uint32_t row = layer_->feature_of(i);
      const bool is_cut_up = stack.add(row, i);
      cut_up_ += is_cut_up ? 1 : 0;
      if (!is_cut_up) add_whole(row, i);
    });
    stack.resolve(cancellation, [&](std::uint32_t row, std::span<const std::uint32_t>,
                                    std::span<const TrapezoidPart> parts) {
      for (const TrapezoidPart& part : parts) {
        add(row, part.share, part.top, part.bottom, part.left, part.right);
      }
    });
    return areas;
  }

 private:
  std::unique_ptr<Layer> layer_;
  std::vector<FeatureStack::Paint> paints_;
  double narrowest_ = 0;
  bool cuts_whole_features_ = false;
  bool is_plain_ = false;
  bool is_fine_ = true;
  std::size_t cut_up_ = 0;
};

using Areas = std::map<std::pair<std::uint32_t, float>, double>;

const std::vector<std::string> kNested = {
    "0 0, 100 0, 100 100, 0 100", "20 20, 60 20, 60 60, 20 60", "50 50, 150 50, 150 150, 50 150"};

TEST(FeatureStackTest, LaterFeaturesLieOverEarlierOnes) {
  EXPECT_EQ(SeenAreas(kNested).areas(),
            (Areas{{{0, 1}, 10'000 - 1600 - 2500 + 100}, {{1, 1}, 1500}, {{2, 1}, 10'000}}));
}

TEST(FeatureStackTest, ARaisedFeatureLiesOverAll) {
  SeenAreas seen(kNested);
  seen.paint(0).is_raised = true;
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 10'000}, {{2, 1}, 7500}}));
  seen.paint(1).is_raised = true;
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 8400}, {{1, 1}, 1600}, {{2, 1}, 7500}}));
}

TEST(FeatureStackTest, ThroughAFeatureThatIsNotOpaqueOthersAreSeen) {
  SeenAreas seen(kNested);
  seen.paint(1).opacity = 0;
  seen.paint(2).opacity = 0.75F;
  EXPECT_EQ(seen.areas(), (Areas{{{0, 0.25F}, 2500},
                                 {{0, 1}, 7500},
                                 {{1, 0.25F}, 100},
                                 {{1, 1}, 1500},
                                 {{2, 1}, 10'000}}));
}

TEST(FeatureStackTest, NarrowOverlapsAreLeftAsTheyAre) {
  SeenAreas seen({"0 0, 100 0, 100 100, 0 100", "95 0, 200 0, 200 100, 95 100"});
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 9500}, {{1, 1}, 10'500}}));
  seen.set_narrowest(6);
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 10'000}, {{1, 1}, 10'500}}));
}

TEST(FeatureStackTest, FeaturesOfOneColourAreLeftWholeWhereAllAreOpaque) {
  SeenAreas seen({"0 0, 1000 0, 1000 1000, 0 1000", "200 200, 600 200, 600 600, 200 600",
                  "500 500, 1500 500, 1500 1500, 500 1500"});
  for (const std::uint32_t row : {0u, 1u, 2u}) seen.paint(row).colour = 7;
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 1e6}, {{1, 1}, 1.6e5}, {{2, 1}, 1e6}}));
  EXPECT_EQ(seen.cut_up(), 0u);
  seen.paint(1).opacity = 0.5F;
  EXPECT_EQ(seen.areas(),
            (Areas{{{0, 0.5F}, 1.5e5}, {{0, 1}, 6e5}, {{1, 1}, 1.5e5}, {{2, 1}, 1e6}}));
  EXPECT_GT(seen.cut_up(), 0u);
}

TEST(FeatureStackTest, FeaturesOfOneColourAreCutWhereTheirBoundariesRunAlongEachOther) {
  // The halves of a square, the square again, and a small one within it.
  const std::vector<std::string> texts = {
      "0 0, 1000 0, 1000 1000, 0 1000", "0 0, 500 0, 500 1000, 0 1000",
      "0 0, 1000 0, 1000 1000, 0 1000", "200 200, 300 200, 300 300, 200 300"};
  SeenAreas seen(texts);
  for (const std::uint32_t row : {0u, 1u, 2u, 3u}) seen.paint(row).colour = 7;
  const Areas expected{{{2, 1}, 1e6}, {{3, 1}, 1e4}};
  EXPECT_EQ(seen.areas(), expected);
  seen.set_plain();
  EXPECT_EQ(seen.areas(), expected);
}

// Their boundaries are 200 cells apart, which may be less than a pixel.
TEST(FeatureStackTest, FeaturesOfOneColourAreCutWherePixelsAreLarge) {
  SeenAreas seen({"0 0, 1000 0, 1000 1000, 0 1000", "200 200, 600 200, 600 600, 200 600"});
  for (const std::uint32_t row : {0u, 1u}) seen.paint(row).colour = 7;
  seen.set_plain();
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 1e6}, {{1, 1}, 1.6e5}}));
  seen.set_coarse();
  EXPECT_EQ(seen.areas(), (Areas{{{0, 1}, 8.4e5}, {{1, 1}, 1.6e5}}));
}

TEST(FeatureStackTest, OnlyTrapezoidsNearOtherFeaturesAreCutUp) {
  // A comb whose teeth are far from the feature over it.
  const std::vector<std::string> texts = {
      "0 0, 1000 0, 1000 50, 900 500, 800 50, 700 500, 600 50, 500 500, 400 50, 0 50",
      "10 10, 30 10, 30 40, 10 40"};
  SeenAreas seen(texts);
  const Areas areas = seen.areas();
  const std::size_t few = seen.cut_up();
  EXPECT_GT(few, 0u);
  seen.cut_whole_features();
  EXPECT_EQ(seen.areas(), areas);
  EXPECT_GT(seen.cut_up(), few);
}

TEST(FeatureStackTest, EndsWhenItIsNotWanted) {
  std::vector<std::string> many(150, "0 0, 100 0, 100 100, 0 100");
  Cancellation cancellation;
  cancellation.cancel();
  EXPECT_THROW(SeenAreas(many).areas(&cancellation), Cancelled);
}

}  // namespace
}  // namespace trapeze
