#include "core/sweep/noding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace trapeze {
namespace {

constexpr std::int32_t kMin = kGridMin;
constexpr std::int32_t kMax = kGridMax;

/// Pieces with their upper end first, in any order.
std::multiset<std::vector<std::int32_t>> as_set(const std::vector<Segment>& segments) {
  std::multiset<std::vector<std::int32_t>> found;
  for (const auto& [a, b] : segments) {
    const auto [upper, lower] = is_above(a, b) ? std::pair(a, b) : std::pair(b, a);
    found.insert({upper.x, upper.y, lower.x, lower.y});
  }
  return found;
}

std::vector<Segment> noded(const std::vector<Segment>& segments, HotCells cells) {
  Boundary boundary;
  boundary.assign(segments);
  return node_segments(segments, boundary, cells).value();
}

void expect_noded(const std::vector<Segment>& segments, const std::vector<Segment>& wanted) {
  for (const HotCells cells : {HotCells::crossings, HotCells::crossings_and_vertices}) {
    EXPECT_EQ(as_set(noded(segments, cells)), as_set(wanted));
  }
}

/// Whether they meet anywhere else than at a shared end; exact, using orientations only.
bool cross_or_touch(const Segment& s, const Segment& t) {
  const auto sign = [](std::int64_t v) { return (v > 0) - (v < 0); };
  const auto side = [&](const Segment& l, Point p) {
    return sign(orientation(l.first, l.second, p));
  };
  const auto is_between = [](const Segment& l, Point p) {
    return p != l.first && p != l.second && is_above(p, l.first) != is_above(p, l.second);
  };
  for (const Point p : {s.first, s.second}) {
    if (side(t, p) == 0 && is_between(t, p)) return true;
  }
  for (const Point p : {t.first, t.second}) {
    if (side(s, p) == 0 && is_between(s, p)) return true;
  }
  return side(t, s.first) * side(t, s.second) < 0 && side(s, t.first) * side(s, t.second) < 0;
}

//    a       c        the crossing is at (5.38, 3.23)
//      \   /
//        x
//      /   \          .
//    d       b
TEST(Noding, ACrossingIsRoundedToTheNearestCell) {
  expect_noded({{{0, 0}, {10, 6}}, {{0, 7}, {10, 0}}},
               {{{0, 0}, {5, 3}}, {{5, 3}, {10, 6}}, {{0, 7}, {5, 3}}, {{5, 3}, {10, 0}}});
}

TEST(Noding, WhatOverlapsCancels) {
  expect_noded({{{0, 0}, {10, 0}}, {{4, 0}, {14, 0}}}, {{{0, 0}, {4, 0}}, {{10, 0}, {14, 0}}});
}

TEST(Noding, WhatIsDrawnTwiceCancelsAndThriceStaysOnce) {
  const Segment s{{3, 4}, {70, 9}};
  expect_noded({s, {s.second, s.first}}, {});
  expect_noded({s, s, s}, {s});
}

TEST(Noding, AVertexOnASegmentDividesIt) {
  expect_noded({{{0, 0}, {10, 0}}, {{5, 0}, {5, 5}}},
               {{{0, 0}, {5, 0}}, {{5, 0}, {10, 0}}, {{5, 0}, {5, 5}}});
}

TEST(Noding, ACommonEndIsNoCrossing) {
  const std::vector<Segment> corner{{{0, 0}, {10, 3}}, {{10, 3}, {0, 20}}, {{10, 3}, {30, 4}}};
  expect_noded(corner, corner);
}

// The first two cross in the middle of the cell (50, 50). The third passes that cell at its right
// side and is bent to its centre, so that no sliver remains between the three crossings.
TEST(Noding, ThreeSegmentsThroughOneCellMeetInItsCentre) {
  expect_noded({{{0, 0}, {100, 100}}, {{0, 100}, {100, 0}}, {{48, 0}, {52, 101}}},
               {{{0, 0}, {50, 50}},
                {{50, 50}, {100, 100}},
                {{0, 100}, {50, 50}},
                {{50, 50}, {100, 0}},
                {{48, 0}, {50, 50}},
                {{50, 50}, {52, 101}}});
}

TEST(Noding, SegmentsOverTheWholeGridAreExact) {
  // Nearly parallel: they diverge by one cell over the whole world.
  expect_noded({{{kMin, kMin}, {kMax, kMax}}, {{kMin, kMin + 1}, {kMax, kMax - 1}}},
               {{{kMin, kMin}, {0, 0}},
                {{0, 0}, {kMax, kMax}},
                {{kMin, kMin + 1}, {0, 0}},
                {{0, 0}, {kMax, kMax - 1}}});
  expect_noded({{{kMin, kMin}, {kMax, kMax}}, {{kMax, kMin}, {kMin, kMax}}},
               {{{kMin, kMin}, {0, 0}},
                {{0, 0}, {kMax, kMax}},
                {{kMax, kMin}, {0, 0}},
                {{0, 0}, {kMin, kMax}}});
  expect_noded({{{kMin, kMin}, {kMax, kMin}}, {{kMin, kMin}, {kMin, kMax}}},
               {{{kMin, kMin}, {kMax, kMin}}, {{kMin, kMin}, {kMin, kMax}}});
}

TEST(Noding, NothingCrossesOrTouchesAfterwards) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const std::int32_t reach = seed % 3 == 0 ? 8 : seed % 3 == 1 ? 300 : kMax;
    std::uniform_int_distribution<std::int32_t> at(-reach, reach);
    std::vector<Segment> segments;
    for (int i = 0; i < 40; ++i) {
      const Segment s{{at(random), at(random)}, {at(random), at(random)}};
      if (s.first != s.second) segments.push_back(s);
    }
    const auto pieces = noded(segments, HotCells::crossings_and_vertices);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        ASSERT_FALSE(cross_or_touch(pieces[i], pieces[k]));
        ASSERT_NE(pieces[i], pieces[k]);
      }
    }
  }
}

// Every point with an odd number of segments keeps an odd number, so rings stay closed.
TEST(Noding, RingsStayClosed) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::int32_t> at(-20, 20);
    Rings rings;
    for (int i = 0; i < 25; ++i) rings.points.push_back({at(random), at(random)});
    rings.close_ring();
    std::vector<Segment> segments = segments_of(rings);
    std::erase_if(segments, [](const Segment& s) { return s.first == s.second; });
    std::multiset<std::pair<std::int32_t, std::int32_t>> ends;
    const auto pieces = noded(segments, HotCells::crossings);
    for (const Segment& s : pieces) {
      for (const Point p : {s.first, s.second}) ends.insert({p.x, p.y});
    }
    for (const auto& p : ends) ASSERT_EQ(ends.count(p) % 2, 0u);
  }
}

}  // namespace
}  // namespace trapeze
