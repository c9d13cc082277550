#include "core/layer/layer_patcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/borders/coverage_groups.h"
#include "core/layer/layer_builder.h"
#include "core/mesh/mesh_index.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/shapes/drawn_trapezoids.h"
#include "tests/core/shapes/maps.h"
#include "tests/sanitized.h"

namespace trapeze {
namespace {

struct Feature {
  std::int64_t id = 0;
  Rings rings;
  std::string name;
};
using Features = std::vector<Feature>;

/// As loading a file of the features would build it.
std::unique_ptr<Layer> build_from(const Features& features, const LayerOptions& options) {
  FeatureTable table(std::vector<Field>{{"name", FieldType::text}, {"points", FieldType::integer}});
  std::vector<Rings> rings;
  for (const Feature& feature : features) {
    const auto points = static_cast<std::int64_t>(feature.rings.points.size());
    const Value number = points % 3 == 0 ? Value() : Value(points);
    table.append(feature.id, std::vector<Value>{std::string_view(feature.name), number});
    rings.push_back(feature.rings);
    if (options.coverage != CoverageMode::off) clean_rings(rings.back());
  }
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  std::vector<bool> is_grouped(features.size(), false);
  if (options.coverage != CoverageMode::off) {
    std::vector<const Rings*> pointers;
    for (const Rings& one : rings) pointers.push_back(&one);
    for (const auto& group : group_features(pointers, options.coverage)) {
      std::vector<const Rings*> members;
      for (const std::uint32_t row : group) {
        members.push_back(pointers[row]);
        is_grouped[row] = true;
      }
      for (const std::uint32_t i : builders.front().add_coverage(group, members).apart) {
        is_grouped[group[i]] = false;
      }
    }
  }
  for (std::uint32_t row = 0; row < features.size(); ++row) {
    if (!is_grouped[row] && !rings[row].empty()) builders.front().add(row, rings[row]);
  }
  return LayerBuilder::join(builders, std::move(table));
}

/// The drawn trapezoids, by feature id.
std::multiset<std::pair<std::int64_t, Drawn>> drawn_of(const Layer& layer, Level level,
                                                       const std::vector<TrapezoidRange>& ranges) {
  std::multiset<std::pair<std::int64_t, Drawn>> all;
  const MeshView& mesh = layer.mesh();
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const MeshTrapezoid& t = mesh.trapezoids[i];
    const auto at = [&](std::uint32_t v) { return mesh.vertices[v]; };
    const MeshEdge left = mesh.edges[t.left];
    const MeshEdge right = mesh.edges[t.right];
    const OutlineView& outline = layer.outline();
    EXPECT_LT(layer.feature_of(i), layer.features().size());
    Drawn one = drawn(outline.loop_size(t.left), at(t.top).y, at(t.bottom).y, at(left.upper),
                      at(left.lower), at(right.upper), at(right.lower));
    all.emplace(layer.features().id(layer.feature_of(i)), one);
    const AlongEdge along = along_edge(mesh, outline, t.left, level);
    EXPECT_GE(std::abs(along.upper) + std::abs(along.lower), 0);
  });
  return all;
}

constexpr Box kEverywhere{kGridMin, kGridMin, kGridMax, kGridMax};

struct DustSum {
  double area = 0;
  double roundings = 0;
};

DustSum dust_of(const Layer& layer, Level level) {
  std::vector<TrapezoidRange> ranges;
  layer.select({kEverywhere, level, level, SmallPolygons::dust}, ranges);
  DustSum sum;
  const MeshView& mesh = layer.mesh();
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    if (layer.feature_of(i) != Layer::kNoFeature) return;
    const MeshTrapezoid& t = mesh.trapezoids[i];
    const double height = mesh.vertices[t.bottom].y - mesh.vertices[t.top].y;
    const double width =
        mesh.vertices[mesh.edges[t.right].upper].x - mesh.vertices[mesh.edges[t.left].upper].x;
    sum.area += width * height;
    sum.roundings += 1.5 + height;
  });
  return sum;
}

std::set<std::tuple<std::int64_t, int, int, int, int, std::int64_t, int, int>> grains_of(
    const Layer& layer) {
  std::set<std::tuple<std::int64_t, int, int, int, int, std::int64_t, int, int>> all;
  for (const FeatureGrain& grain : layer.grains().grains()) {
    all.emplace(layer.features().id(grain.row), grain.from.x, grain.from.y, grain.to.x, grain.to.y,
                grain.doubled_area, grain.born, grain.is_covered);
  }
  EXPECT_TRUE(std::ranges::is_sorted(layer.grains().grains(), {},
                                     [](const FeatureGrain& g) { return order_key(g); }));
  return all;
}

std::set<std::tuple<std::int64_t, std::int64_t, std::uint32_t, std::uint32_t>> overlaps_of(
    const Layer& layer) {
  std::set<std::tuple<std::int64_t, std::int64_t, std::uint32_t, std::uint32_t>> all;
  for (const FeatureOverlap& pair : layer.overlaps().pairs()) {
    all.emplace(layer.features().id(pair.row), layer.features().id(pair.other), pair.width,
                pair.along);
  }
  return all;
}

std::string attributes_of(const Layer& layer, std::uint32_t row) {
  const Value name = layer.features().value(row, 0);
  const Value points = layer.features().value(row, 1);
  const auto* number = std::get_if<std::int64_t>(&points);
  return std::string(std::get<std::string_view>(name)) +
         (number == nullptr ? "" : std::to_string(*number));
}

/// The existing features, by id.
std::map<std::int64_t, std::pair<Rings, std::string>> features_of(const Layer& layer) {
  std::map<std::int64_t, std::pair<Rings, std::string>> all;
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    if (layer.is_removed(row)) continue;
    Rings rings;
    layer.append_outline(row, rings);
    all[layer.features().id(row)] = {rings, attributes_of(layer, row)};
  }
  return all;
}

/// Expects that the index finds those of `all` that meet the box, in ascending order.
void expect_found(const Layer& layer, Level level, const std::vector<TrapezoidRange>& all,
                  const Box& box) {
  std::vector<TrapezoidRange> ranges;
  layer.select({box, level, level, SmallPolygons::dust}, ranges);
  std::vector<std::uint32_t> found;
  for_each_trapezoid(ranges, [&](std::uint32_t i) { found.push_back(i); });
  EXPECT_TRUE(std::ranges::is_sorted(found));
  for_each_trapezoid(all, [&](std::uint32_t i) {
    if (!meets(layer.mesh(), layer.mesh().trapezoids[i], box)) return;
    EXPECT_TRUE(std::ranges::binary_search(found, i));
  });
}

template <typename Set>
std::vector<typename Set::value_type> difference(const Set& one, const Set& other) {
  std::vector<typename Set::value_type> items;
  std::ranges::set_symmetric_difference(one, other, std::back_inserter(items));
  return items;
}

void expect_same(const Layer& patched, const Layer& whole) {
  EXPECT_EQ(features_of(patched), features_of(whole));
  EXPECT_THAT(difference(grains_of(patched), grains_of(whole)), ::testing::IsEmpty());
  EXPECT_THAT(difference(overlaps_of(patched), overlaps_of(whole)), ::testing::IsEmpty());
  for (int level = 0; level <= kLastLevel; level += 9) {
    SCOPED_TRACE("level " + std::to_string(level));
    const auto at = static_cast<Level>(level);
    std::vector<TrapezoidRange> one;
    std::vector<TrapezoidRange> other;
    patched.select({kEverywhere, at, at, SmallPolygons::drop}, one);
    whole.select({kEverywhere, at, at, SmallPolygons::drop}, other);
    EXPECT_THAT(difference(drawn_of(patched, at, one), drawn_of(whole, at, other)),
                ::testing::IsEmpty());
    expect_found(patched, at, one, {-3000, -3000, 5000, 4000});
    patched.select_horizontal_edges(kEverywhere, at, one);
    whole.select_horizontal_edges(kEverywhere, at, other);
    EXPECT_THAT(difference(drawn_of(patched, at, one), drawn_of(whole, at, other)),
                ::testing::IsEmpty());
    const DustSum dust = dust_of(patched, at);
    const DustSum expected = dust_of(whole, at);
    EXPECT_NEAR(dust.area, expected.area, 2 * (dust.roundings + expected.roundings));
  }
}

/// A map whose features are edited, and its layer.
class Edited {
 public:
  Edited(unsigned seed, const LayerOptions& options) : random_(seed), options_(options) {
    for (Rings& rings : sample_map(seed)) features_.push_back({next_id_++, rings, name()});
    first_features_ = features_;
    patcher_ = std::make_unique<LayerPatcher>(*build_from(features_, options));
  }

  /// Changes a few features at the same time.
  LayerChanges edit(int count) {
    std::set<std::int64_t> changed;
    for (int i = 0; i < count; ++i) changed.insert(edit_one());
    const std::vector<std::int64_t> ids(changed.begin(), changed.end());
    Features now;
    for (const Feature& feature : features_) {
      if (changed.contains(feature.id)) now.push_back(feature);
    }
    std::vector<Box> places;
    for (const Feature& feature : now) {
      places.emplace_back();
      for (const Point p : feature.rings.points) places.back().include(p);
    }
    const std::vector<std::int64_t> to_build = patcher_->ids_to_build(ids, places, 4);
    Features features;
    for (const std::int64_t id : to_build) {
      const auto feature = std::ranges::find(features_, id, &Feature::id);
      if (feature != features_.end()) features.push_back(*feature);
    }
    return patcher_->apply({to_build, *build_from(features, options_)});
  }

  /// The features are reset to the first state, too.
  void start_over() {
    patcher_->start_over();
    features_ = first_features_;
  }

  const Layer& patched() const { return *patcher_->now(); }
  const LayerPatcher& patcher() const { return *patcher_; }
  std::unique_ptr<Layer> whole() const { return build_from(features_, options_); }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }
  std::string name() { return "name " + std::to_string(below(7)); }

  std::int64_t edit_one() {
    Feature& feature = features_[below(features_.size())];
    const std::int64_t id = feature.id;
    switch (below(6)) {
      case 0:
        features_.push_back({next_id_, moved_by(feature.rings, {300, 200}), name()});
        return next_id_++;
      case 1:
        features_.erase(features_.begin() + (&feature - features_.data()));
        break;
      case 2:
        feature.name = "renamed";
        break;
      case 3:
        if (!feature.rings.points.empty()) {
          feature.rings.points[below(feature.rings.points.size())].x += 7;
        }
        break;
      case 4:
        feature.rings = random_shape(static_cast<unsigned>(below(1000)));
        break;
      default:
        feature.rings = moved_by(feature.rings, {1300, -500});
    }
    return id;
  }

  std::mt19937 random_;
  const LayerOptions options_;
  std::int64_t next_id_ = 100;
  Features first_features_;
  Features features_;  // new ones are last, as in the layer
  std::unique_ptr<LayerPatcher> patcher_;
};

TEST(LayerPatcherTest, APatchedLayerIsTheOneBuiltAnew) {
  for (const CoverageMode coverage :
       {CoverageMode::off, CoverageMode::automatic, CoverageMode::on}) {
    for (unsigned seed = 0; seed < (testing::kIsSanitized ? 2 : 10); ++seed) {
      SCOPED_TRACE("coverage " + std::string(kCoverageNames.name_of(coverage)) + ", seed " +
                   std::to_string(seed));
      LayerOptions options;
      options.coverage = coverage;
      Edited map(seed, options);
      expect_same(map.patched(), *map.whole());
      for (int step = 0; step < 8; ++step) {
        SCOPED_TRACE("step " + std::to_string(step));
        map.edit(1 + step % 3);
        expect_same(map.patched(), *map.whole());
        if (::testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST(LayerPatcherTest, StatesThatAreInUseStayAsTheyWere) {
  Edited map(3, {});
  const std::shared_ptr<const Layer> first = map.patcher().now();
  const std::unique_ptr<Layer> whole = map.whole();
  for (int step = 0; step < 5; ++step) map.edit(3);
  expect_same(*first, *whole);
}

TEST(LayerPatcherTest, StartsOverFromTheFirstState) {
  Edited map(5, {});
  const std::unique_ptr<Layer> whole = map.whole();
  for (int step = 0; step < 4; ++step) map.edit(2);
  EXPECT_EQ(map.patcher().patches(), 4u);
  map.start_over();
  EXPECT_EQ(map.patcher().patches(), 0u);
  expect_same(map.patched(), *whole);
  for (int step = 0; step < 4; ++step) {
    map.edit(2);
    expect_same(map.patched(), *map.whole());
  }
}

TEST(LayerPatcherTest, ChangesAreWhereSomethingLooksDifferent) {
  Edited map(7, {});
  for (int step = 0; step < 10; ++step) {
    const std::shared_ptr<const Layer> before = map.patcher().now();
    const LayerChanges told = map.edit(1);
    Box all;
    for (const LayerChanges::Place& place : told.places) all.include(place.box);
    for (const LayerChanges::Side& side :
         changes_between(*before, map.patched(), Ids::do_not_matter).sides) {
      Box box;
      box.include(side.upper);
      box.include(side.lower);
      EXPECT_TRUE(all.intersects(box));
    }
  }
}

TEST(LayerPatcherTest, AFeatureThatIsNoLongerOverlappedMayLookDifferentEverywhere) {
  LayerOptions options;
  options.coverage = CoverageMode::off;
  const auto square = [](std::int32_t from, std::int32_t to) {
    Rings rings;
    rings.add(std::vector<Point>{{from, from}, {to, from}, {to, to}, {from, to}});
    return rings;
  };
  const Features features = {{1, square(0, 4000), "a"}, {2, square(3000, 5000), "b"}};
  LayerPatcher patcher(*build_from(features, options));
  const std::vector<std::int64_t> gone = {2};
  const std::vector<std::int64_t> to_build = patcher.ids_to_build(gone, {}, 4);
  ASSERT_EQ(to_build, gone);
  const LayerChanges changes = patcher.apply({to_build, *build_from({}, options)});
  Box others;
  for (const LayerChanges::Place& place : changes.places) others.include(place.other);
  EXPECT_EQ(others, (Box{0, 0, 4000, 4000}));
}

TEST(LayerPatcherTest, RefusesFeaturesOfOneIdAndOtherAttributes) {
  const Features twice = {{1, random_shape(1), "a"}, {1, random_shape(2), "b"}};
  EXPECT_THROW(LayerPatcher(*build_from(twice, {})), std::invalid_argument);
  const Features once = {{1, random_shape(1), "a"}};
  LayerPatcher patcher(*build_from(once, {}));
  const std::vector<std::int64_t> ids = {1};
  EXPECT_THROW(patcher.apply({ids, *build_from(twice, {})}), std::invalid_argument);
  std::vector<LayerBuilder> builders;
  builders.emplace_back(LayerOptions());
  FeatureTable other(std::vector<Field>{{"height", FieldType::real}});
  other.append(1, std::vector<Value>{2.5});
  const auto layer = LayerBuilder::join(builders, std::move(other));
  EXPECT_THROW(patcher.apply({ids, *layer}), std::invalid_argument);
  EXPECT_EQ(patcher.now(), patcher.first());
}

}  // namespace
}  // namespace trapeze
