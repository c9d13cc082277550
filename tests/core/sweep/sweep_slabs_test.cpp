// Several threads build the same as a single thread.
#include "core/sweep/sweep_slabs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "core/grid/radix_sort.h"
#include "core/layer/layer_builder.h"
#include "core/sweep/meetings.h"
#include "core/sweep/trapezoidation.h"
#include "tests/core/shapes/same_layers.h"

namespace trapeze {
namespace {

constexpr unsigned kThreads[] = {2, 3, 8};

/// Parcels in columns and rows, with bent borders that neighbours share, or that cross. Every third
/// row of corners is straight, so that many vertices have the same y.
std::vector<Rings> parcels(int side, bool do_cross) {
  constexpr int kSize = 1000;
  constexpr int kPieces = 4;  // of a border
  std::mt19937 random(1);
  const auto bent = [&random](int most) {
    return static_cast<std::int32_t>(random() % (2u * static_cast<unsigned>(most) + 1)) - most;
  };
  // The points where borders start to the right and down, and the points along these borders.
  const auto at = [&](int column, int row) { return column * (side + 1) + row; };
  std::vector<std::vector<Point>> across;
  std::vector<std::vector<Point>> down;
  for (int column = 0; column <= side; ++column) {
    for (int row = 0; row <= side; ++row) {
      const Point corner{column * kSize, row * kSize};
      auto& to_the_right = across.emplace_back(1, corner);
      auto& to_the_bottom = down.emplace_back(1, corner);
      for (int i = 1; i < kPieces; ++i) {
        const std::int32_t along = i * kSize / kPieces;
        to_the_right.push_back({corner.x + along, corner.y + (row % 3 == 0 ? 0 : bent(90))});
        to_the_bottom.push_back({corner.x + bent(90), corner.y + along});
      }
    }
  }
  std::vector<Rings> features;
  for (int column = 0; column < side; ++column) {
    for (int row = 0; row < side; ++row) {
      const auto i = [&](int c, int r) {
        return static_cast<std::size_t>(at(column + c, row + r));
      };
      std::vector<Point> ring = across[i(0, 0)];
      ring.insert(ring.end(), down[i(1, 0)].begin(), down[i(1, 0)].end());
      ring.push_back(across[i(1, 1)].front());
      ring.insert(ring.end(), across[i(0, 1)].rbegin(), across[i(0, 1)].rend() - 1);
      ring.push_back(down[i(0, 1)].front());
      ring.insert(ring.end(), down[i(0, 0)].rbegin(), down[i(0, 0)].rend() - 1);
      if (do_cross && (column + row) % 7 == 0) {
        ring[1].y -= 30;
        ring[2].y += 30;
      }
      features.emplace_back().add(ring);
    }
  }
  return features;
}

std::vector<Segment> random_segments(std::size_t count, std::int32_t reach) {
  std::mt19937 random(2);
  std::vector<Segment> segments;
  const auto coordinate = [&random] { return static_cast<std::int32_t>(random() % 100'000); };
  const auto step = [&] {
    return static_cast<std::int32_t>(random() % (2u * static_cast<unsigned>(reach) + 1)) - reach;
  };
  while (segments.size() < count) {
    const Point a{coordinate(), coordinate() / 10};
    const Point b{a.x + step(), a.y + step()};
    if (a != b) segments.emplace_back(a, b);
  }
  return segments;
}

TEST(SweepSlabs, BeginWithRowsAndHoldAllVertices) {
  Boundary boundary;
  boundary.assign(random_segments(50'000, 20));
  const std::vector<VertexId> firsts = cut_into_slabs(boundary, 8);
  ASSERT_EQ(firsts.size(), 9u);
  EXPECT_EQ(firsts.front(), VertexId(1));
  EXPECT_EQ(firsts.back().value + 1u, boundary.vertices.size());
  for (std::size_t i = 1; i + 1 < firsts.size(); ++i) {
    EXPECT_LT(firsts[i - 1], firsts[i]);
    EXPECT_LT(boundary.vertices[VertexId(firsts[i].value - 1u)].y, boundary.vertices[firsts[i]].y);
  }
  boundary.assign(random_segments(50, 20));
  EXPECT_EQ(cut_into_slabs(boundary, 8).size(), 2u) << "too few for more than one";
}

TEST(SweepSlabs, MeetingsDoNotDependOnTheNumberOfThreads) {
  for (const std::int32_t reach : {5, 50, 1000}) {
    Boundary boundary;
    boundary.assign(random_segments(40'000, reach));
    constexpr std::size_t kAny = 100'000'000;
    const std::vector<Point> one = find_meetings(boundary, kAny).value();
    EXPECT_FALSE(one.empty());
    for (const unsigned threads : kThreads) {
      EXPECT_EQ(find_meetings(boundary, kAny, threads), one) << threads << " threads, " << reach;
      EXPECT_EQ(find_meetings(boundary, one.size() / 2, threads), std::nullopt);
    }
  }
}

TEST(SweepSlabs, WhatIsNotNodedIsRefusedByAnyNumberOfThreads) {
  const FaceBeyond next = [](EdgeId, FaceId left) { return left + 1; };
  // A crossing far down, below segments that do not meet.
  std::vector<Segment> segments;
  for (std::int32_t i = 0; i < 40'000; ++i) segments.push_back({{0, 10 * i}, {5, 10 * i + 5}});
  segments.push_back({{100, 390'000}, {200, 390'100}});
  segments.push_back({{200, 390'000}, {100, 390'100}});
  Boundary boundary;
  boundary.assign(segments);
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    TrapezoidalGraph graph;
    EXPECT_FALSE(Trapezoidation().build(boundary, next, graph, threads)) << threads;
  }
}

TEST(SweepSlabs, TheGraphOfACoverageDoesNotDependOnTheNumberOfThreads) {
  for (const bool do_cross : {false, true}) {
    const std::vector<Rings> features = parcels(100, do_cross);
    std::vector<const Rings*> pointers;
    for (const Rings& rings : features) pointers.push_back(&rings);
    TrapezoidalGraph one;
    const CoverageOutcome outcome = CoverageBuilder().build(pointers, {1, 0}, one);
    ASSERT_TRUE(outcome.built) << outcome.failure;
    EXPECT_EQ(outcome.noded, do_cross);
    for (const unsigned threads : kThreads) {
      TrapezoidalGraph graph;
      ASSERT_TRUE(CoverageBuilder().build(pointers, {1, 0}, graph, nullptr, threads).built);
      EXPECT_TRUE(graph == one) << threads << " threads";
    }
  }
}

TEST(SweepSlabs, TheLayerOfACoverageDoesNotDependOnTheNumberOfThreads) {
  const std::vector<Rings> features = parcels(60, true);
  const auto layer_by = [&features](unsigned threads) {
    LayerOptions options;
    options.coverage = CoverageMode::automatic;
    std::vector<LayerBuilder> builders;
    builders.emplace_back(options);
    FeatureTable table(std::vector<Field>{});
    std::vector<std::uint32_t> rows;
    std::vector<const Rings*> pointers;
    for (const Rings& rings : features) {
      rows.push_back(table.append(static_cast<std::int64_t>(rows.size()), {}));
      pointers.push_back(&rings);
    }
    EXPECT_TRUE(builders.front().add_coverage(rows, pointers, threads).apart.empty());
    return LayerBuilder::join(builders, std::move(table));
  };
  const std::unique_ptr<Layer> one = layer_by(1);
  for (const unsigned threads : kThreads) {
    SCOPED_TRACE(testing::Message() << threads << " threads");
    expect_same_layers(*one, *layer_by(threads));
  }
}

TEST(RadixSort, IsThatByKeyAndIndexWhateverTheNumberOfThreads) {
  std::mt19937_64 random(3);
  for (const std::size_t count : {0u, 1u, 100u, 5'000u, 300'000u}) {
    for (const std::uint64_t most : {std::uint64_t{7}, ~std::uint64_t{0}}) {
      LargeArray<KeyedIndex> items;
      for (std::uint32_t i = 0; i < count; ++i) items.push_back({random() & most, i});
      LargeArray<KeyedIndex> sorted = items;
      std::sort(sorted.begin(), sorted.end());
      for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        LargeArray<KeyedIndex> copy = items;
        LargeArray<KeyedIndex> scratch;
        sort_by_key(copy, scratch, threads);
        EXPECT_TRUE(copy == sorted) << count << " by " << threads;
      }
    }
  }
}

}  // namespace
}  // namespace trapeze
