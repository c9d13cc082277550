#include "core/borders/part_union.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "core/sweep/graph_builder.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

struct United {
  PartUnion found;
  Rings rings;

  /// Each part is given separately.
  explicit United(const std::vector<std::string>& parts) {
    std::vector<std::uint32_t> ends;
    for (const std::string& part : parts) {
      const Rings of_part = rings_from_text(part);
      for (std::size_t r = 0; r < of_part.size(); ++r) rings.add(of_part[r]);
      ends.push_back(static_cast<std::uint32_t>(rings.size()));
    }
    drawn = rings;
    found = unite_parts(rings, ends);
    EXPECT_EQ(found.failure, "");
    EXPECT_EQ(rings == drawn, !found.did_overlap);
  }

  double area() const {
    Rings copy = rings;
    TrapezoidalGraph graph;
    GraphBuilder().build(copy, graph);
    return static_cast<double>(graph.doubled_area()) / 2;
  }

  Rings drawn;
};

constexpr const char* kSquare = "0 0, 100 0, 100 100, 0 100";

TEST(PartUnion, PartThatIsThereTwiceIsThereOnce) {
  const United u({kSquare, kSquare});
  EXPECT_TRUE(u.found.did_overlap);
  EXPECT_EQ(u.area(), 10'000);
  EXPECT_EQ(United({kSquare, kSquare, kSquare, "200 0, 300 0, 300 100, 200 100"}).area(), 20'000);
}

TEST(PartUnion, ThousandsOfEqualPartsAreOneWhereverTheirRingsBegin) {
  std::vector<std::string> parts(4000, kSquare);
  parts[7] = "100 100, 0 100, 0 0, 100 0";
  parts[8] = "0 100, 100 100, 100 0, 0 0";
  EXPECT_EQ(United(parts).area(), 10'000);
  parts.push_back("50 50, 150 50, 150 150, 50 150");
  EXPECT_EQ(United(parts).area(), 2 * 10'000 - 2'500);
}

TEST(PartUnion, PartsWithoutAreaDoNotCount) {
  const std::string line = "0 0, 100 0, 50 0";
  const United u({line, kSquare, line});
  EXPECT_FALSE(u.found.did_overlap);
  EXPECT_EQ(u.area(), 10'000);
}

TEST(PartUnion, WhatTwoPartsCoverIsNoHole) {
  const United u({kSquare, "50 50, 150 50, 150 150, 50 150"});
  EXPECT_TRUE(u.found.did_overlap);
  EXPECT_EQ(u.area(), 2 * 10'000 - 2'500);
}

TEST(PartUnion, PartsThatCrossWithoutAVertexInEachOtherAreUnited) {
  EXPECT_EQ(United({"0 40, 100 40, 100 60, 0 60", "40 0, 60 0, 60 100, 40 100"}).area(),
            2 * 2'000 - 400);
}

TEST(PartUnion, PartWithinAnotherIsNoHole) {
  const United u({kSquare, "40 40, 60 40, 60 60, 40 60"});
  EXPECT_TRUE(u.found.did_overlap);
  EXPECT_EQ(u.area(), 10'000);
}

TEST(PartUnion, HolesAndIslandsInThemRemain) {
  const std::string ring = "0 0, 100 0, 100 100, 0 100; 10 10, 90 10, 90 90, 10 90";
  const United u({ring, "40 40, 60 40, 60 60, 40 60"});
  EXPECT_FALSE(u.found.did_overlap);
  EXPECT_EQ(u.area(), 3'600 + 400);
  // A hole that another part covers is no hole.
  EXPECT_EQ(United({ring, kSquare}).area(), 10'000);
}

TEST(PartUnion, PartsThatTouchDoNotOverlap) {
  const United edge({kSquare, "100 0, 200 0, 200 100, 100 100"});
  EXPECT_FALSE(edge.found.did_overlap);
  EXPECT_EQ(edge.area(), 20'000);
  EXPECT_FALSE(United({kSquare, "100 100, 200 100, 200 200, 100 200"}).found.did_overlap);
}

TEST(PartUnion, ManyPartsApartAreLeftAsTheyAre) {
  // Too many to be compared box by box; the bay of the first contains all others.
  std::vector<std::string> parts{"-10 -10, 900 -10, 900 0, 0 0, 0 900, -10 900"};
  for (int i = 0; i < 400; ++i) {
    const int x = 20 + 20 * (i % 20);
    const int y = 20 + 20 * (i / 20);
    const auto corner = [](int u, int v) { return std::to_string(u) + " " + std::to_string(v); };
    parts.push_back(corner(x, y) + ", " + corner(x + 10, y) + ", " + corner(x, y + 10));
  }
  EXPECT_FALSE(United(parts).found.did_overlap);
  parts.push_back("200 200, 230 200, 200 230");
  EXPECT_TRUE(United(parts).found.did_overlap);
}

TEST(PartUnion, IsWhatEachPartCoversOfItself) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> at(0, 12);
    // Rectangles on a small grid: a cell is either covered or not.
    std::vector<std::string> parts;
    std::vector<bool> is_covered(13 * 13, false);
    for (int i = 0; i < 2 + static_cast<int>(seed % 5); ++i) {
      const int left = at(random);
      const int top = at(random);
      const int right = left + 1 + at(random) % (13 - left);
      const int bottom = top + 1 + at(random) % (13 - top);
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) is_covered[static_cast<std::size_t>(13 * y + x)] = true;
      }
      const auto corner = [](int x, int y) { return std::to_string(x) + " " + std::to_string(y); };
      parts.push_back(corner(left, top) + ", " + corner(right, top) + ", " + corner(right, bottom) +
                      ", " + corner(left, bottom));
    }
    const auto covered = std::count(is_covered.begin(), is_covered.end(), true);
    ASSERT_EQ(United(parts).area(), static_cast<double>(covered));
  }
}

TEST(PartUnion, PartThatCoversOnlyALaterRingOfAnotherIsNoHole) {
  const United u({"500 0, 510 0, 510 10, 500 10; 40 40, 60 40, 60 60, 40 60", kSquare});
  EXPECT_TRUE(u.found.did_overlap);
  EXPECT_EQ(u.area(), 10'000 + 100);
  // Two rings within each other, the hole of the inner one first.
  const char* outer = "-100 -100, 100 -100, 100 100, -100 100; -50 -50, 50 -50, 50 50, -50 50";
  const char* inner = "-40 -40, 40 -40, 40 40, -40 40; -70 -70, 70 -70, 70 70, -70 70";
  EXPECT_EQ(United({outer, inner}).area(), 200 * 200 - 80 * 80);
}

}  // namespace
}  // namespace trapeze
