#include "tests/hostile/hostile_polygons.h"

#include <cfloat>
#include <limits>
#include <numbers>
#include <utility>

namespace trapeze {
namespace {

using Features = std::vector<HostileFeature>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One feature with one polygon of these rings.
Features polygon(LonLatPolygon rings) {
  return {{.parts = {std::move(rings)}}};
}

Features ring(LonLatRing ring) {
  return polygon({std::move(ring)});
}

/// One feature, with a part for each ring.
Features parts(const std::vector<LonLatRing>& rings) {
  HostileFeature feature;
  for (const LonLatRing& ring : rings) feature.parts.push_back({ring});
  return {feature};
}

/// A feature for each ring.
Features apart(const std::vector<LonLatRing>& rings) {
  Features features;
  for (const LonLatRing& ring : rings) features.push_back({.parts = {{ring}}});
  return features;
}

Features wkt(const std::vector<std::string>& texts) {
  Features features;
  for (const std::string& text : texts) features.push_back({.wkt = text});
  return features;
}

LonLatPolygon with_holes(LonLatRing shell, std::vector<LonLatRing> holes) {
  holes.insert(holes.begin(), std::move(shell));
  return holes;
}

std::vector<LonLatRing> copies(const LonLatRing& ring, int count, double east = 0,
                               double north = 0) {
  std::vector<LonLatRing> all;
  for (int i = 0; i < count; ++i) all.push_back(moved(ring, i * east, i * north));
  return all;
}

/// Three squares; the middle one has that position as a corner.
Features ring_with(LonLat position) {
  LonLatRing wrong = square(0, 0, 1);
  wrong[2] = position;
  return apart({square(2, 0, 1), wrong, square(4, 0, 1)});
}

std::vector<LonLatRing> fan_of_slivers(int count, double length, double thickness) {
  std::vector<LonLatRing> slivers;
  for (int i = 0; i < count; ++i) {
    slivers.push_back(sliver(length, thickness, 2 * std::numbers::pi * i / count));
  }
  return slivers;
}

/// Wedges that share their sides, around one vertex.
std::vector<LonLatRing> wedges(int count, double radius) {
  const LonLatRing rim = star(count, radius, radius);
  std::vector<LonLatRing> all;
  for (std::size_t i = 0; i < rim.size(); ++i) {
    all.push_back({{0, 0}, rim[i], rim[(i + 1) % rim.size()]});
  }
  return all;
}

std::vector<LonLatRing> slivers_side_by_side(int count, double length, double thickness,
                                             double radians) {
  return copies(sliver(length, thickness, radians), count, 2 * thickness, 10 * thickness);
}

/// Overlapping rectangles, some along and some across.
std::vector<LonLatRing> weave(int count) {
  std::vector<LonLatRing> strips;
  for (int i = 0; i < count; ++i) {
    const double at = 10.0 * i / count;
    const double width = 5.0 / count;
    strips.push_back(rectangle(0, at, 10, at + width));
    strips.push_back(rectangle(at, 0, at + width, 10));
  }
  return strips;
}

/// Both sides of a border meander by less than a cell.
std::vector<LonLatRing> neighbours_that_nearly_touch(int points) {
  LonLatRing left{{-1, 0}};
  LonLatRing right{{1, 0}};
  for (int i = 0; i <= points; ++i) {
    const double lat = 10.0 * i / points;
    left.push_back({(i % 3 - 1) * kCellDegrees, lat});
    right.push_back({(i % 2) * kCellDegrees, lat});
  }
  left.push_back({-1, 10});
  right.push_back({1, 10});
  return {left, right};
}

std::string collection_of_depth(int depth) {
  std::string text = "POLYGON((0 0,1 0,1 1,0 0))";
  for (int i = 0; i < depth; ++i) text = "GEOMETRYCOLLECTION(" + text + ")";
  return text;
}

Features with_texts(Features features, const std::string& text) {
  for (HostileFeature& feature : features) feature.text = text;
  return features;
}

Features joined(Features a, const Features& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// clang-format off
const HostileInput kInputs[] = {
    // Empty or nearly empty sources.
    {"NoFeatures", [] { return Features(); }},
    {"NoGeometry", [] { return Features(5); }},
    {"EmptyPolygon", [] { return wkt({"POLYGON EMPTY", "MULTIPOLYGON EMPTY", "GEOMETRYCOLLECTION EMPTY"}); }},
    {"PointsAndLines", [] { return wkt({"POINT(1 1)", "LINESTRING(0 0,1 1)", "MULTIPOINT(1 1,2 2)"}); }},
    {"PolygonAmongPointsAndLines", [] { return wkt({"GEOMETRYCOLLECTION(POINT(1 1),POLYGON((0 0,1 0,1 1,0 0)),LINESTRING(0 0,9 9))"}); }},
    {"EmptyPartAmongOthers", [] { return Features{{.parts = {{}, {square(0, 0, 1)}, {}}}}; }},
    {"EmptyHole", [] { return polygon({square(0, 0, 1), {}}); }},
    {"EmptyShellWithAHole", [] { return polygon({{}, square(0, 0, 1)}); }},
    {"RingOfOnePosition", [] { return ring({{1, 1}}); }},
    {"RingOfTwoPositions", [] { return ring({{1, 1}, {2, 2}}); }},
    {"RingThatIsOnePositionOftenRepeated", [] { return ring(repeated({{1, 1}}, 10'000)); }},
    {"CornersRepeatedAThousandTimes", [] { return ring(repeated(square(0, 0, 1), 1000)); }},
    {"CollinearRing", [] { return ring({{0, 0}, {1, 1}, {2, 2}}); }},
    {"HorizontalCollinearRing", [] { return ring({{0, 0}, {2, 0}, {1, 0}, {5, 0}}); }},
    {"ThereAndBackAlongOneLine", [] { return ring(there_and_back(5000)); }},
    {"SquareWithASpikeOfNoWidth", [] { return ring({{0, 0}, {1, 0}, {1, 1}, {9, 9}, {1, 1}, {0, 1}}); }},
    {"SquareTwiceAround", [] { return ring({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}}); }},
    {"SquareOnceEachWayAround", [] { return ring({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {0, 1}, {1, 1}, {1, 0}}); }},
    {"PolygonSmallerThanACell", [] { return ring(square(0, 0, kCellDegrees / 3)); }},
    {"PolygonOfOneCell", [] { return ring(square(0, 0, kCellDegrees)); }},
    {"TenThousandPolygonsSmallerThanACell", [] { return apart(lattice_of_squares(100, 1e-3, kCellDegrees / 3)); }},
    {"TenThousandPolygonsOfOneCell", [] { return apart(lattice_of_squares(100, 1e-3, 2 * kCellDegrees)); }},
    {"OneEdgeOfACell", [] { return ring({{0, 0}, {60, 60}, {60 + kCellDegrees, 60}}); }},

    // Values that are not numbers, and coordinates at the ends of the earth.
    {"NaN", [] { return ring_with({kNaN, 1}); }},
    {"NaNLatitude", [] { return ring_with({1, kNaN}); }},
    {"Infinity", [] { return ring_with({kInfinity, 1}); }},
    {"MinusInfinity", [] { return ring_with({1, -kInfinity}); }},
    {"AllNaN", [] { return ring({{kNaN, kNaN}, {kNaN, kNaN}, {kNaN, kNaN}}); }},
    {"NaNInAHole", [] { return polygon({square(0, 0, 3), {{1, 1}, {2, kNaN}, {2, 2}}}); }},
    {"GreatestDouble", [] { return ring_with({DBL_MAX, DBL_MAX}); }},
    {"GreatestDoubles", [] { return ring({{-DBL_MAX, -DBL_MAX}, {DBL_MAX, -DBL_MAX}, {0, DBL_MAX}}); }},
    {"LeastDoubles", [] { return ring({{DBL_TRUE_MIN, 0}, {0, DBL_TRUE_MIN}, {-DBL_TRUE_MIN, -0.0}}); }},
    {"MinusZero", [] { return ring({{-0.0, 0.0}, {1, -0.0}, {1, 1}, {0.0, -0.0}}); }},
    {"MillionsOfDegrees", [] { return ring({{-1e6, -1e6}, {1e6, -1e6}, {1e6, 1e6}, {-1e6, 1e6}}); }},
    {"LongitudeOfTenTurns", [] { return ring(rectangle(3600, 0, 3601, 1)); }},
    {"TwiceAroundTheEarth", [] { return ring(rectangle(-360, -10, 360, 10)); }},
    {"WholeWorld", [] { return ring(rectangle(-180, -90, 180, 90)); }},
    {"WholeSquareOfTheMap", [] { return ring(rectangle(-180, -kMaxLatitude, 180, kMaxLatitude)); }},
    {"WorldAsAHole", [] { return polygon({square(0, 0, 1), rectangle(-180, -90, 180, 90)}); }},
    {"WorldWithTenThousandHoles", [] { return polygon(with_holes(rectangle(-180, -90, 180, 90), lattice_of_squares(100, 0.5, 0.2))); }},
    {"ThousandWorlds", [] { return apart(copies(rectangle(-180, -90, 180, 90), 1000)); }},
    {"AlongThe180thMeridian", [] { return ring(rectangle(170, -10, 190, 10)); }},
    {"OnThe180thMeridianOnBothSides", [] { return apart({rectangle(179, 0, 180, 1), rectangle(-180, 0, -179, 1)}); }},
    {"AcrossThe180thMeridianTheLongWay", [] { return ring({{179, 0}, {-179, 0}, {-179, 1}, {179, 1}}); }},
    {"CapsOfThePoles", [] { return apart({rectangle(-180, 84, 180, 90), rectangle(-180, -90, 180, -84)}); }},
    {"BeyondTheMapTowardsThePole", [] { return ring(rectangle(0, 86, 10, 89)); }},
    {"OneCellAlongTheNorthernEdge", [] { return ring(rectangle(-180, kMaxLatitude - 1e-9, 180, 90)); }},
    {"StripOfOneCellAroundTheEarth", [] { return ring(rectangle(-180, 0, 180, kCellDegrees)); }},
    {"DiagonalOfTheWorldOneCellWide", [] { return ring({{-180, -85}, {180, 85}, {180, 85 - 2 * kCellDegrees}}); }},
    {"ThousandDiagonalsOfTheWorld", [] { return apart(copies({{-180, -85}, {170, 85}, {171, 85}}, 1000, 1e-3, 0)); }},
    {"CornersOfTheMap", [] { return apart({rectangle(-180, 85, -179, 86), rectangle(179, 85, 180, 86), rectangle(-180, -86, -179, -85), rectangle(179, -86, 180, -85)}); }},
    {"StarOverTheWholeWorld", [] { return ring(star(20'000, 1, 170)); }},
    {"MetresFarOutside", [] { return ring(rectangle(-1e12, -1e12, 1e12, 1e12)); }, "EPSG:3857"},
    {"MetresOfTheGreatestDouble", [] { return ring({{-DBL_MAX, -DBL_MAX}, {DBL_MAX, -DBL_MAX}, {0, DBL_MAX}}); }, "EPSG:3857"},
    {"MetresAtTheCorners", [] { return ring(rectangle(-kMercatorHalfSide, -kMercatorHalfSide, kMercatorHalfSide, kMercatorHalfSide)); }, "EPSG:3857"},
    {"MetresOfManyTurns", [] { return ring(rectangle(-1e9, -10, 1e9, 10)); }, "EPSG:3857"},
    {"NaNMetres", [] { return ring_with({kNaN, 1}); }, "EPSG:3857"},
    {"ZoneFarFromItsMeridian", [] { return ring(rectangle(-3e7, -3e7, 3e7, 3e7)); }, "EPSG:32632"},
    {"ZoneThatCoversAPole", [] { return ring(rectangle(-2e6, 9e6, 2e6, 1.1e7)); }, "EPSG:32632"},
    {"AroundThePole", [] { return ring(star(1000, 1e6, 2e6)); }, "EPSG:3031"},
    {"DegreesTakenForMetres", [] { return apart(lattice_of_squares(20, 1, 0.5)); }, "EPSG:3857"},
    {"NoReferenceSystemAndNoDegrees", [] { return ring(rectangle(500'000, 0, 600'000, 100'000)); }, ""},

    // Rings that cross themselves.
    {"BowTie", [] { return ring({{0, 0}, {1, 1}, {1, 0}, {0, 1}}); }},
    {"ChainOf5000BowTies", [] { return ring(chain_of_bow_ties(5000)); }},
    {"TenThousandBowTiesInOnePlace", [] { return apart(copies({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 10'000)); }},
    {"Pentagram", [] { return ring(star_polygon(5, 2, 5)); }},
    {"StarPolygonOf101", [] { return ring(star_polygon(101, 50, 5)); }},
    {"StarPolygonOf1001", [] { return ring(star_polygon(1001, 500, 5)); }},
    {"StarPolygonOf10001", [] { return ring(star_polygon(10'001, 5000, 5)); }},
    {"StarPolygonSmallerThanItsCorners", [] { return ring(star_polygon(1001, 500, 20 * kCellDegrees)); }},
    {"SoupOf100", [] { return ring(soup(100, 10, 1)); }},
    {"SoupOf1000", [] { return ring(soup(1000, 10, 2)); }},
    {"SoupOf10000", [] { return ring(soup(10'000, 10, 3)); }},
    {"SoupOf100000", [] { return ring(soup(100'000, 10, 4)); }},
    {"SoupInAPixel", [] { return ring(soup(2000, 200 * kCellDegrees, 5)); }},
    {"SoupInFewCells", [] { return ring(soup(20'000, 8 * kCellDegrees, 6)); }},
    {"SoupOnALattice", [] { return ring(lattice_soup(2000, 20, 0.1, 7)); }},
    {"SoupOnACoarseLattice", [] { return ring(lattice_soup(20'000, 4, 1, 8)); }},
    {"SoupOfHundredRings", [] { std::vector<LonLatRing> rings; for (unsigned i = 0; i < 100; ++i) rings.push_back(soup(30, 10, i)); return polygon(rings); }},
    {"SoupOfHundredParts", [] { std::vector<LonLatRing> rings; for (unsigned i = 0; i < 100; ++i) rings.push_back(soup(30, 10, i)); return parts(rings); }},
    {"SoupOfHundredFeatures", [] { std::vector<LonLatRing> rings; for (unsigned i = 0; i < 100; ++i) rings.push_back(soup(30, 10, i)); return apart(rings); }},
    {"RandomWalk", [] { return ring(random_walk(20'000, 0.01, 1)); }},
    {"RandomWalkInFewCells", [] { return ring(random_walk(50'000, kCellDegrees, 2)); }},
    {"DragonCurve", [] { return ring(dragon_curve(14, 0.01)); }},
    {"DragonCurveOfCells", [] { return ring(dragon_curve(14, 2 * kCellDegrees)); }},
    {"Lissajous", [] { return ring(lissajous(20'000, 17, 18)); }},
    {"LissajousThatRepeatsItself", [] { return ring(lissajous(20'000, 20, 40)); }},
    {"FlowerOf5000Petals", [] { return ring(flower(5000, 5)); }},
    {"FlowerInAPixel", [] { return ring(flower(5000, 100 * kCellDegrees)); }},
    {"SpiralWhoseArmsOverlap", [] { return ring(spiral(100, 60, 1.5)); }},
    {"CombThatLeansOverItself", [] { return ring(comb(500, 0.01, 5, 3)); }},
    {"CombOfLongDiagonalsWithOneBowTie", [] { return ring(with_bow_tie_in_the_middle(comb(20'000, 1e-4, 5, 5))); }},
    {"CombWithOneBowTie", [] { return ring(with_bow_tie_in_the_middle(comb(20'000, 1e-4, 5, 0))); }},
    {"SpikyStarWithOneBowTie", [] { return ring(with_bow_tie_in_the_middle(star(20'000, 0.5, 5))); }},

    // Simple rings that are long, thin or deep.
    {"CombOf50000Teeth", [] { return ring(comb(50'000, 1e-4, 5, 0)); }},
    {"CombOfLongDiagonals", [] { return ring(comb(150'000, 1e-4, 5, 5)); }},
    {"CombOnItsSide", [] { LonLatRing c = comb(50'000, 1e-4, 5, 0); for (LonLat& p : c) std::swap(p.lon, p.lat); return ring(c); }},
    {"CombWithTeethNarrowerThanACell", [] { return ring(comb(20'000, kCellDegrees / 2, 5, 0)); }},
    {"CombOfOneCellTeeth", [] { return ring(comb(20'000, 2 * kCellDegrees, 5, 0)); }},
    {"CombsInEachOther", [] { return apart({comb(5000, 1e-3, 5, 0), moved(comb(5000, 1e-3, 5, 0), 5e-4, -0.1)}); }},
    {"CombsAcrossEachOther", [] { LonLatRing c = comb(300, 0.03, 9, 0); LonLatRing d = c; for (LonLat& p : d) std::swap(p.lon, p.lat); return apart({c, d}); }},
    {"Battlements", [] { return ring(battlements(20'000, 1e-4, 1)); }},
    {"BattlementsOfOneCell", [] { return ring(battlements(20'000, 2 * kCellDegrees, kCellDegrees)); }},
    {"Staircase", [] { return ring(staircase(50'000, 1e-4)); }},
    {"StaircaseOfCells", [] { return ring(staircase(50'000, kCellDegrees)); }},
    {"SpiralOf500Turns", [] { return ring(spiral(500, 100, 0.5)); }},
    {"SpiralNarrowerThanACell", [] { return ring(spiral(200, 100, 1e-5)); }},
    {"SquareSpiral", [] { return ring(spiral(5000, 4, 0.5)); }},
    {"SpikyStarOf50000", [] { return ring(star(50'000, 0.5, 5)); }},
    {"SpikyStarOfNeedles", [] { return ring(star(20'000, 1e-6, 60)); }},
    {"StarInAPixel", [] { return ring(star(20'000, 50 * kCellDegrees, 200 * kCellDegrees)); }},
    {"CircleOf200000", [] { return ring(star(200'000, 5, 5)); }},
    {"CircleOf200000InAPixel", [] { return ring(star(200'000, 100 * kCellDegrees, 100 * kCellDegrees)); }},
    {"TwoHundredThousandVerticesInAPixel", [] { return ring(soup(200'000, 2 * kCellDegrees, 9)); }},
    {"KochSnowflake", [] { return ring(koch_snowflake(7, 5)); }},
    {"KochSnowflakeFinerThanCells", [] { return ring(koch_snowflake(7, 500 * kCellDegrees)); }},
    {"HilbertRibbon", [] { return ring(hilbert_ribbon(7, 10, 0.4)); }},
    {"HilbertRibbonThatTouchesItself", [] { return ring(hilbert_ribbon(6, 10, 1)); }},
    {"SliverAlongEachSide", [] { return ring({{0, 0}, {10, 0}, {10, kCellDegrees}, {5, 2 * kCellDegrees}, {0, kCellDegrees}}); }},
    {"FiveHundredSlivers", [] { return apart(slivers_side_by_side(500, 10, 1e-5, 0.7)); }},
    {"FiveHundredSliversOfACell", [] { return apart(slivers_side_by_side(500, 10, 2 * kCellDegrees, 0.7)); }},
    {"FiveHundredLevelSlivers", [] { return apart(slivers_side_by_side(500, 10, 1e-5, 0)); }},
    {"FanOfSlivers", [] { return apart(fan_of_slivers(500, 5, 1e-5)); }},
    {"FanOfSliversAsParts", [] { return parts(fan_of_slivers(500, 5, 1e-5)); }},
    {"FanOfSliversAsRings", [] { return polygon(fan_of_slivers(500, 5, 1e-5)); }},

    // Holes.
    {"HoleEqualToItsShell", [] { return polygon({square(0, 0, 1), square(0, 0, 1)}); }},
    {"HoleEqualToItsShellTheOtherWay", [] { return polygon({square(0, 0, 1), reversed(square(0, 0, 1))}); }},
    {"HoleOutside", [] { return polygon({square(0, 0, 1), square(5, 5, 1)}); }},
    {"HoleAroundItsShell", [] { return polygon({square(1, 1, 1), square(0, 0, 3)}); }},
    {"HoleAcrossItsShell", [] { return polygon({square(0, 0, 1), square(0.5, 0.5, 1)}); }},
    {"HoleThatTouchesItsShellAtACorner", [] { return polygon({square(0, 0, 3), {{0, 0}, {2, 1}, {1, 2}}}); }},
    {"HoleThatTouchesItsShellAtEveryCorner", [] { return polygon({square(0, 0, 2), {{1, 0}, {2, 1}, {1, 2}, {0, 1}}}); }},
    {"HoleThatSharesASide", [] { return polygon({square(0, 0, 3), square(0, 1, 1)}); }},
    {"HoleOnAHole", [] { return polygon({square(0, 0, 3), square(1, 1, 1), square(1, 1, 1)}); }},
    {"HolesThatTouchEachOther", [] { return polygon(with_holes(square(-1, -1, 12), checkerboard(60, 0.1))); }},
    {"HolesThatShareSides", [] { return polygon(with_holes(square(-1, -1, 12), lattice_of_squares(60, 0.1, 0.1))); }},
    {"HolesThatOverlap", [] { return polygon(with_holes(square(-1, -1, 12), lattice_of_squares(40, 0.1, 0.25))); }},
    {"ThousandHolesInOnePlace", [] { return polygon(with_holes(square(-1, -1, 3), copies(square(0, 0, 1), 1000))); }},
    {"HolesOfOneCellAcrossABorder", [] { return polygon(with_holes(square(0, 0, 1), copies(square(-kCellDegrees, 0, 2 * kCellDegrees), 2000, 0, 5e-4))); }},
    {"SierpinskiHoles", [] { return polygon(with_holes({{0, 0}, {8, 0}, {0, 8}}, sierpinski_holes(8, 8))); }},
    {"FortyThousandHoles", [] { return polygon(with_holes(square(-1, -1, 22), lattice_of_squares(200, 0.1, 0.05))); }},
    {"RingsNested10000Deep", [] { return polygon(nested_squares(10'000, 1e-4)); }},
    {"RingsNestedMoreTightlyThanCells", [] { return polygon(nested_squares(5000, kCellDegrees / 2)); }},
    {"PartsNested2000Deep", [] { return parts(nested_squares(2000, 1e-3)); }},
    {"FeaturesNested2000Deep", [] { return apart(nested_squares(2000, 1e-3)); }},

    // Parts.
    {"EqualParts", [] { return parts(copies(square(0, 0, 1), 2)); }},
    {"ThousandEqualParts", [] { return parts(copies(square(0, 0, 1), 1000)); }},
    {"EqualPartsTheOtherWayAround", [] { return parts({square(0, 0, 1), reversed(square(0, 0, 1))}); }},
    {"EqualPartsWithHoles", [] { const LonLatPolygon p{square(0, 0, 3), square(1, 1, 1)}; return Features{{.parts = {p, p, p}}}; }},
    {"OverlappingParts", [] { return parts(copies(square(0, 0, 1), 300, 0.1, 0.05)); }},
    {"PartsMovedByOneCell", [] { return parts(copies(star(200, 1, 2), 20, kCellDegrees, kCellDegrees)); }},
    {"PartsThatShareSides", [] { return parts(lattice_of_squares(60, 0.1, 0.1)); }},
    {"PartsThatTouchAtCorners", [] { return parts(checkerboard(60, 0.1)); }},
    {"PartsThatFillEachOthersHoles", [] { return Features{{.parts = {{square(0, 0, 3), square(1, 1, 1)}, {square(1, 1, 1)}}}}; }},
    {"PartsThatCrossThemselves", [] { return parts({star_polygon(51, 25, 5), star_polygon(53, 26, 4)}); }},
    {"WovenParts", [] { return parts(weave(40)); }},
    {"TwentyThousandParts", [] { return parts(lattice_of_squares(140, 0.05, 0.02)); }},
    {"ThousandRandomTrianglesAsParts", [] { return parts(random_triangles(1000, 2, 1)); }},
    {"ThousandRandomTrianglesAsRings", [] { return polygon(random_triangles(1000, 2, 1)); }},
    {"CollectionsThirtyDeep", [] { return wkt({collection_of_depth(30)}); }},
    {"CurvesThatCross", [] { return wkt({"CURVEPOLYGON(CIRCULARSTRING(0 0,2 2,4 0,1 3,0 0))", "MULTISURFACE(CURVEPOLYGON(CIRCULARSTRING(0 0,1 1,2 0,1 -1,0 0)),((0 0,1 0,1 1,0 0)))"}); }},
    {"SurfacesOfTriangles", [] { return wkt({"TIN(((0 0,1 0,1 1,0 0)),((0 0,1 1,0 1,0 0)))", "POLYHEDRALSURFACE(((0 0,1 0,1 1,0 0)),((0 0,1 0,1 1,0 0)))", "TRIANGLE((0 0,1 0,1 1,0 0))"}); }},
    {"WallsWithoutGroundArea", [] { return wkt({"POLYGON Z((0 0 0,1 0 0,1 0 9,0 0 9,0 0 0))"}); }},

    // Features beside, around and over each other.
    {"TenThousandEqualFeatures", [] { return apart(copies(square(0, 0, 1), 10'000)); }},
    {"StarsOverEachOther", [] { return apart(copies(star(100, 1, 2), 300)); }},
    {"LayerTwice", [] { return joined(apart(lattice_of_squares(60, 0.1, 0.1)), apart(lattice_of_squares(60, 0.1, 0.1))); }},
    {"LayerTwiceAndMovedByACell", [] { return joined(apart(lattice_of_squares(40, 0.1, 0.1)), apart(lattice_of_squares(40, 0.1, 0.1 + kCellDegrees))); }},
    {"LayerTwiceAndHalfASquareAside", [] { return joined(apart(lattice_of_squares(40, 0.1, 0.1)), apart(copies(square(0.05, 0.05, 4), 1))); }},
    {"BoardOfFeatures", [] { return apart(checkerboard(100, 0.1)); }},
    {"BoardOfFeaturesOfOneCell", [] { return apart(checkerboard(100, kCellDegrees)); }},
    {"FeaturesAroundOneVertex", [] { return apart(wedges(2000, 5)); }},
    {"FeaturesAroundOneVertexInAPixel", [] { return apart(wedges(2000, 100 * kCellDegrees)); }},
    {"FeaturesMovedByOneCell", [] { return apart(copies(star(200, 1, 2), 50, kCellDegrees, kCellDegrees)); }},
    {"FeaturesThatNearlyShareABorder", [] { return apart(neighbours_that_nearly_touch(5000)); }},
    {"WovenFeatures", [] { return apart(weave(60)); }},
    {"ThousandRandomTriangles", [] { return apart(random_triangles(1000, 2, 1)); }},
    {"ThousandLargeRandomTriangles", [] { return apart(random_triangles(1000, 20, 2)); }},
    {"TwentyThousandSmallRandomTriangles", [] { return apart(random_triangles(20'000, 0.05, 3)); }},
    {"StairOfFeaturesThatOverlapALittle", [] { return apart(copies(square(0, 0, 1), 1000, 0.01, 0.99)); }},
    {"RowOfFeaturesEachWithinTheNext", [] { std::vector<LonLatRing> r; for (int i = 1; i <= 500; ++i) r.push_back(rectangle(0, 0, 0.01 * i, 1)); return apart(r); }},
    {"OneFeatureAroundTenThousand", [] { return joined(apart({square(-1, -1, 12)}), apart(lattice_of_squares(100, 0.1, 0.05))); }},
    {"SpiralsInEachOther", [] { return apart({spiral(50, 100, 0.5), reversed(spiral(50, 100, 0.5))}); }},

    // Attributes.
    {"LongTexts", [] { return with_texts(apart(lattice_of_squares(5, 1, 0.5)), std::string(1'000'000, 'x')); }},
    {"ManyTexts", [] { return with_texts(apart(lattice_of_squares(70, 0.1, 0.05)), std::string(1000, 'y')); }},
    {"TextsThatAreNoText", [] { return with_texts(ring(square(0, 0, 1)), "\xff\xfe\xc0\x80\x1b[31m\r\n\"'<script>"); }},
};
// clang-format on

}  // namespace

std::span<const HostileInput> hostile_inputs() {
  return kInputs;
}

}  // namespace trapeze
