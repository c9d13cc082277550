#include "core/layer/layer_arrays.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/layer/layer_builder.h"
#include "core/layer/untested_layer.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

std::unique_ptr<Layer> sample_layer() {
  std::vector<LayerBuilder> builders(1);
  FeatureTable features({{"name", FieldType::text}, {"size", FieldType::integer}});
  for (unsigned seed = 0; seed < 80; ++seed) {
    const std::string name = "shape " + std::to_string(seed % 9);
    const Value size = seed % 3 == 0 ? Value() : Value(std::int64_t{seed});
    Rings rings = random_shape(seed);
    builders[0].add(features.append(seed + 1000, std::vector<Value>{std::string_view(name), size}),
                    rings);
  }
  return LayerBuilder::join(builders, std::move(features));
}

/// Copies of all arrays, so that a test can corrupt them.
struct Copies {
  explicit Copies(const LayerArrays& a)
      : vertices(a.vertices.begin(), a.vertices.end()),
        edges(a.edges.begin(), a.edges.end()),
        trapezoids(a.trapezoids.begin(), a.trapezoids.end()),
        lifespans(a.lifespans.begin(), a.lifespans.end()),
        feature_of(a.feature_of.begin(), a.feature_of.end()),
        polygon_index(a.polygon_index.begin(), a.polygon_index.end()),
        horizontal_edge_index(a.horizontal_edge_index.begin(), a.horizontal_edge_index.end()),
        mote_index(a.mote_index.begin(), a.mote_index.end()),
        grains(a.grains.begin(), a.grains.end()),
        outline_points(a.outline_points.begin(), a.outline_points.end()),
        ring_ends(a.ring_ends.begin(), a.ring_ends.end()),
        outline_ends(a.outline_ends.begin(), a.outline_ends.end()),
        loop_sizes(a.outline.loop_sizes.begin(), a.outline.loop_sizes.end()),
        milestone_ends(a.outline.milestone_ends.begin(), a.outline.milestone_ends.end()),
        milestone_levels(a.outline.milestone_levels.begin(), a.outline.milestone_levels.end()),
        feature_units(a.units.features.begin(), a.units.features.end()),
        group_units(a.units.groups.begin(), a.units.groups.end()),
        group_members(a.units.members.begin(), a.units.members.end()),
        rest(a) {}

  LayerArrays arrays() const {
    LayerArrays a = rest;
    a.vertices = vertices;
    a.edges = edges;
    a.trapezoids = trapezoids;
    a.lifespans = lifespans;
    a.feature_of = feature_of;
    a.polygon_index = polygon_index;
    a.horizontal_edge_index = horizontal_edge_index;
    a.mote_index = mote_index;
    a.grains = grains;
    a.outline_points = outline_points;
    a.ring_ends = ring_ends;
    a.outline_ends = outline_ends;
    a.outline.loop_sizes = loop_sizes;
    a.outline.milestone_ends = milestone_ends;
    a.outline.milestone_levels = milestone_levels;
    a.units.features = feature_units;
    a.units.groups = group_units;
    a.units.members = group_members;
    return a;
  }

  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;
  std::vector<std::uint32_t> feature_of;
  std::vector<MeshIndex::Entry> polygon_index;
  std::vector<MeshIndex::Entry> horizontal_edge_index;
  std::vector<MeshIndex::Entry> mote_index;
  std::vector<FeatureGrain> grains;
  std::vector<Point> outline_points;
  std::vector<std::uint32_t> ring_ends;
  std::vector<std::uint32_t> outline_ends;
  std::vector<LoopSize> loop_sizes;
  std::vector<std::uint32_t> milestone_ends;
  std::vector<Level> milestone_levels;
  std::vector<FeatureUnit> feature_units;
  std::vector<GroupUnit> group_units;
  std::vector<GroupMember> group_members;
  LayerArrays rest;
};

std::vector<Point> outline_of(const Layer& layer, std::uint32_t row) {
  Rings rings;
  layer.append_outline(row, rings);
  return rings.points;
}

TEST(LayerArrays, GiveALayerThatAnswersAsTheOneTheyWereTakenFrom) {
  const auto built = sample_layer();
  const auto again = layer_from(arrays_of(*built), nullptr);
  EXPECT_EQ(again->bounds(), built->bounds());
  EXPECT_EQ(again->size().motes, built->size().motes);
  EXPECT_EQ(again->mesh().trapezoids.data(), built->mesh().trapezoids.data())
      << "nothing is copied";
  EXPECT_NE(again->mesh().id, built->mesh().id);
  std::vector<TrapezoidRange> expected;
  std::vector<TrapezoidRange> ranges;
  for (Level level = 0; level <= kLastLevel; ++level) {
    for (const SmallPolygons small : {SmallPolygons::dust, SmallPolygons::drop}) {
      const Layer::Selection selection{{-900, -900, 4000, 2000}, level, kLastLevel, small};
      built->select(selection, expected);
      again->select(selection, ranges);
      EXPECT_EQ(ranges, expected) << "level " << int{level};
    }
  }
  for (std::uint32_t row = 0; row < built->features().size(); ++row) {
    EXPECT_EQ(again->features().id(row), built->features().id(row));
    EXPECT_EQ(again->features().value(row, 0), built->features().value(row, 0));
    EXPECT_EQ(again->features().value(row, 1), built->features().value(row, 1));
    EXPECT_EQ(outline_of(*again, row), outline_of(*built, row));
  }
  for (std::uint32_t t = 0; t < built->mesh().trapezoids.size(); ++t) {
    EXPECT_EQ(again->feature_of(t), built->feature_of(t));
  }
  EXPECT_TRUE(std::ranges::equal(build_without_topology_test(*again)->mesh().trapezoids,
                                 build_without_topology_test(*built)->mesh().trapezoids));
}

TEST(LayerArrays, KnowThatOverlapsAreMissing) {
  const auto built = sample_layer();
  LayerArrays arrays = arrays_of(*built);
  EXPECT_TRUE(layer_from(arrays, nullptr)->has_all_overlaps());
  arrays.has_all_overlaps = false;
  const auto again = layer_from(arrays, nullptr);
  EXPECT_FALSE(again->has_all_overlaps());
  EXPECT_FALSE(arrays_of(*again).has_all_overlaps);
}

TEST(LayerArrays, OfABuiltLayerTakeNoMoreMemoryThanTheirItems) {
  const auto layer = sample_layer();
  const LayerArrays a = arrays_of(*layer);
  const std::size_t items =
      a.vertices.size_bytes() + a.edges.size_bytes() + a.trapezoids.size_bytes() +
      a.lifespans.size_bytes() + a.feature_of.size_bytes() + a.polygon_index.size_bytes() +
      a.mote_index.size_bytes() + a.merged_mote_index.size_bytes() +
      a.horizontal_edge_index.size_bytes() + a.outline_points.size_bytes() +
      a.ring_ends.size_bytes() + a.outline_ends.size_bytes() + a.outline.loop_sizes.size_bytes() +
      a.outline.milestone_ends.size_bytes() + a.outline.milestones.size_bytes() +
      a.outline.milestone_levels.size_bytes() + a.units.features.size_bytes() +
      a.units.groups.size_bytes() + a.units.members.size_bytes() + a.units.overlaps.size_bytes() +
      layer->grains().memory() + layer->overlaps().memory();
  EXPECT_EQ(layer->memory(), items);
  EXPECT_LE(layer->grains().memory(), a.grains.size_bytes() * 11 / 10 + 64);
  EXPECT_LE(layer->overlaps().memory(),
            a.overlaps.size_bytes() + 5 * (layer->features().size() + 1));
  std::size_t cells = a.cells.ids.size_bytes() + a.cells.string_bytes.size_bytes() +
                      a.cells.string_ends.size_bytes();
  for (const auto& column : a.cells.columns) {
    cells += column.numbers.size_bytes() + column.nulls.size_bytes() + column.texts.size_bytes();
  }
  EXPECT_LE(layer->features().memory(), cells + 1000) << "names of fields are the rest";
}

TEST(LayerArrays, OfALayerWithoutAnythingGiveOne) {
  std::vector<LayerBuilder> builders(1);
  const auto empty = LayerBuilder::join(builders, FeatureTable());
  const auto again = layer_from(arrays_of(*empty), nullptr);
  EXPECT_TRUE(again->bounds().is_empty());
  std::vector<TrapezoidRange> ranges;
  again->select({.box = {kGridMin, kGridMin, kGridMax, kGridMax}}, ranges);
  EXPECT_TRUE(ranges.empty());
}

TEST(LayerArrays, KeepWhatTheyLookAtWhileTheLayerLives) {
  const auto built = sample_layer();
  auto memory = std::make_shared<int>(0);
  const std::weak_ptr<int> watched = memory;
  auto again = layer_from(arrays_of(*built), std::move(memory));
  EXPECT_FALSE(watched.expired());
  again.reset();
  EXPECT_TRUE(watched.expired());
}

TEST(LayerArrays, AreRefusedInWordsWhereSomethingLeadsNowhere) {
  const auto layer = sample_layer();
  const std::uint32_t far = 0xfffffff0;
  const std::vector<std::pair<std::function<void(Copies&)>, const char*>> spoilers = {
      {[](Copies& c) { c.vertices[3].x = kGridMax + 1; }, "vertex is not on the grid"},
      {[](Copies& c) { c.vertices[3].y = kGridMin - 1; }, "vertex is not on the grid"},
      {[&](Copies& c) { c.edges[5].upper = far; }, "end of an edge"},
      {[&](Copies& c) { c.edges[5].lower = static_cast<std::uint32_t>(c.vertices.size()); },
       "end of an edge"},
      {[&](Copies& c) { c.trapezoids.back().top = far; }, "trapezoid"},
      {[&](Copies& c) { c.trapezoids[0].bottom = far; }, "trapezoid"},
      {[&](Copies& c) { c.trapezoids[0].left = far; }, "trapezoid"},
      {[](Copies& c) { c.trapezoids[0].right = static_cast<std::uint32_t>(c.edges.size()); },
       "trapezoid"},
      {[](Copies& c) {
         const auto t = std::ranges::find_if(c.trapezoids, [&c](const MeshTrapezoid& trapezoid) {
           return c.vertices[trapezoid.top].y != c.vertices[trapezoid.bottom].y;
         });
         std::swap(t->top, t->bottom);
       },
       "between its edges"},
      {[](Copies& c) {
         MeshEdge& edge = c.edges[c.trapezoids[0].left];
         edge.lower = edge.upper = c.trapezoids[0].bottom;
         c.vertices[edge.upper].y += 1;
       },
       "between its edges"},
      {[](Copies& c) { c.lifespans.pop_back(); }, "lifespan"},
      {[](Copies& c) { c.feature_of[7] = 80; }, "feature of a trapezoid"},
      {[](Copies& c) { c.feature_of.resize(c.trapezoids.size() + 1); }, "dust that has a feature"},
      {[](Copies& c) { c.feature_of.pop_back(); }, "sums"},
      {[](Copies& c) { c.polygon_index.pop_back(); }, "index"},
      {[](Copies& c) { c.mote_index.emplace_back(); }, "index"},
      {[](Copies& c) { c.horizontal_edge_index.emplace_back(); }, "index"},
      {[&](Copies& c) { c.rest.horizontal_edges = far; }, "sums"},
      {[](Copies& c) { c.grains[2].row = 80; }, "grain of dust"},
      {[](Copies& c) { c.grains[2].born = kLastLevel + 1; }, "grain of dust"},
      {[](Copies& c) { c.grains[2].is_covered = 2; }, "grain of dust"},
      {[](Copies& c) { c.feature_units[3].row = 80; }, "feature of a unit"},
      {[](Copies& c) {
         c.group_members.push_back({{}, 80, 0});
       },
       "feature of a unit"},
      {[](Copies& c) {
         c.group_members.push_back({{}, 0, 0});
       },
       "groups are not in order"},
      {[](Copies& c) { c.group_units.emplace_back().members_end = 1; }, "groups are not in order"},
      {[](Copies& c) { c.group_units.emplace_back().overlaps_end = 1; }, "groups are not in order"},
      {[](Copies& c) { c.grains[2].to.y = kGridMax + 1; }, "grain of dust"},
      {[](Copies& c) { c.outline_points[1].x = kGridMin - 1; }, "point of an outline"},
      {[&](Copies& c) { c.ring_ends.back() = far; }, "rings are not in order"},
      {[&](Copies& c) { c.ring_ends[1] = far; }, "rings are not in order"},
      {[&](Copies& c) { c.outline_ends.back() = far; }, "outlines are not in order"},
      {[](Copies& c) { std::swap(c.outline_ends[0], c.outline_ends[1]); },
       "outlines are not in order"},
      {[](Copies& c) { c.outline_ends.resize(81, c.outline_ends.back()); },
       "outlines without a feature"},
      {[&](Copies& c) { c.rest.single_motes = far; }, "too much dust"},
      {[](Copies& c) { c.rest.size.motes += 1; }, "sums"},
      {[](Copies& c) { c.rest.bounds.min_x = kGridMin - 1; }, "bounds"},
      {[](Copies& c) { c.rest.bounds.max_y = c.rest.bounds.min_y - 1; }, "bounds"},
      {[](Copies& c) { c.rest.fields.pop_back(); }, "column"},
      {[](Copies& c) { c.loop_sizes.resize(c.edges.size() + 1); }, "loops without edges"},
      {[&](Copies& c) { c.milestone_ends.back() = far; }, "milestones are not in order"},
      {[&](Copies& c) { c.milestone_ends[3] = far; }, "milestones are not in order"},
      {[](Copies& c) { c.milestone_ends.resize(c.vertices.size() + 1, c.milestone_ends.back()); },
       "milestones are not in order"},
      {[](Copies& c) { c.milestone_levels.pop_back(); }, "milestones are not in order"},
  };
  for (const auto& [spoil, says] : spoilers) {
    Copies copies(arrays_of(*layer));
    ASSERT_NO_THROW(layer_from(copies.arrays(), nullptr));
    spoil(copies);
    try {
      layer_from(copies.arrays(), nullptr);
      ADD_FAILURE() << "was taken: " << says;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(says));
    }
  }
}

}  // namespace
}  // namespace trapeze
