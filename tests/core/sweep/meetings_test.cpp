#include "core/sweep/meetings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace trapeze {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

int sign(std::int64_t v) {
  return (v > 0) - (v < 0);
}

/// floor(a / b + 1/2).
Int128 round_half_up(Int128 a, Int128 b) {
  const Int128 n = b < 0 ? -2 * a - b : 2 * a + b;
  const Int128 d = b < 0 ? -2 * b : 2 * b;
  return n % d < 0 ? n / d - 1 : n / d;
}

void append_end_within(Point p, const Segment& s, std::vector<Point>& points) {
  if (p == s.first || p == s.second || orientation(s.first, s.second, p) != 0) return;
  if (box_of(s).intersects(Box{p.x, p.y, p.x, p.y})) points.push_back(p);
}

/// Tests every pair.
std::vector<Point> meetings_of_pairs(const std::vector<Segment>& segments) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto& [s, t] = std::pair(segments[i], segments[k]);
      for (const Point p : {s.first, s.second}) append_end_within(p, t, points);
      for (const Point p : {t.first, t.second}) append_end_within(p, s, points);
      const Int128 a = orientation(t.first, t.second, s.first);
      const Int128 b = orientation(t.first, t.second, s.second);
      const int c = sign(orientation(s.first, s.second, t.first)) *
                    sign(orientation(s.first, s.second, t.second));
      if ((a < 0) == (b < 0) || a == 0 || b == 0 || c >= 0) continue;
      const auto at = [a, b](std::int32_t from, std::int32_t to) {
        return static_cast<std::int32_t>(
            from + round_half_up((static_cast<Int128>(to) - from) * a, a - b));
      };
      points.push_back({at(s.first.x, s.second.x), at(s.first.y, s.second.y)});
    }
  }
  std::sort(points.begin(), points.end(), is_above);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::vector<Segment> random_segments(unsigned seed, int count, std::int32_t reach) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> at(-reach, reach);
  std::vector<Segment> segments;
  while (std::ssize(segments) < count) {
    const Segment s{{at(random), at(random)}, {at(random), at(random)}};
    if (s.first != s.second) segments.push_back(s);
  }
  return segments;
}

TEST(Meetings, AreTheSameAsOfEachSegmentWithEachOther) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const std::int32_t reach : {2, 5, 12, 300, 1 << 20, kGridMax}) {
      const auto segments = random_segments(seed, 5 + static_cast<int>(seed % 40), reach);
      ASSERT_EQ(find_meetings(segments, kAnyNumber), meetings_of_pairs(segments))
          << "reach " << reach;
    }
  }
}

TEST(Meetings, SegmentsThatCoincideOrOverlapDoNotHideOthers) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto segments = random_segments(seed, 12, 6);
    const auto copies = segments;
    segments.insert(segments.end(), copies.begin(), copies.begin() + 6);
    // Segments on the same line, at least twice as long.
    for (std::size_t i = 6; i < 12; ++i) {
      const auto [a, b] = copies[i];
      segments.push_back({a, {3 * b.x - 2 * a.x, 3 * b.y - 2 * a.y}});
    }
    ASSERT_EQ(find_meetings(segments, kAnyNumber), meetings_of_pairs(segments));
  }
}

TEST(Meetings, CommonEndsAreNone) {
  EXPECT_THAT(find_meetings({{{0, 0}, {10, 3}}, {{10, 3}, {0, 20}}, {{10, 3}, {30, 4}}}, 0).value(),
              IsEmpty());
}

// All segments share an end, and their boxes overlap there: testing every pair with overlapping
// boxes would take minutes.
TEST(Meetings, SpokesOfAWheelAreFewSteps) {
  std::vector<Segment> spokes;
  for (std::int32_t i = 0; i < 200'000; ++i) spokes.push_back({{0, 0}, {1'000'000 - i, i}});
  EXPECT_THAT(find_meetings(spokes, 0).value(), IsEmpty());
}

//  ////////   long diagonals beside each other, and one that crosses the first
TEST(Meetings, DiagonalsBesideEachOtherAreFewSteps) {
  std::vector<Segment> diagonals;
  for (std::int32_t i = 0; i < 200'000; ++i) {
    diagonals.push_back({{10 * i, 0}, {10 * i + 5'000'000, 5'000'000}});
  }
  diagonals.push_back({{-2, 1'000'003}, {2'000'002, 1'000'000}});
  EXPECT_EQ(find_meetings(diagonals, kAnyNumber)->size(), 100'001u);
}

TEST(Meetings, MoreThanAreWantedAreNone) {
  // Nine crossings.
  std::vector<Segment> grid;
  for (std::int32_t i = 1; i <= 3; ++i) {
    grid.push_back({{0, i}, {4, i}});
    grid.push_back({{i, 0}, {i, 4}});
  }
  EXPECT_EQ(find_meetings(grid, 9)->size(), 9u);
  EXPECT_EQ(find_meetings(grid, 8), std::nullopt);
  // An end on two segments that cross there: two meetings.
  const std::vector<Segment> cross{{{0, 0}, {4, 4}}, {{4, 0}, {0, 4}}, {{2, 2}, {9, 3}}};
  EXPECT_THAT(find_meetings(cross, 2).value(), ElementsAre(Point{2, 2}));
  EXPECT_EQ(find_meetings(cross, 1), std::nullopt);
}

}  // namespace
}  // namespace trapeze
