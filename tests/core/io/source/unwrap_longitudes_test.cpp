#include "core/io/source/unwrap_longitudes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace trapeze {
namespace {

constexpr double kMetresOfDegree = 100'000;

/// A plane that is cut at x = 0: just west of it lies 170 degrees west, just east of it 0.
SourcePlane cut_plane() {
  const auto to_lonlat = [](std::vector<double>& x, std::vector<double>& y) {
    for (double& each : x) each = each < 0 ? -170 + each / kMetresOfDegree : each / kMetresOfDegree;
    for (double& each : y) each /= kMetresOfDegree;
    return true;
  };
  return {to_lonlat, 1};
}

// However many vertices a ring has, the search for the cut of its plane does not recurse below a
// centimetre.
TEST(UnwrapLongitudes, AnEdgeOverACutOfThePlaneGoesTheShorterWay) {
  constexpr std::size_t kVertices = 400'000;
  const SourcePlane plane = cut_plane();
  PositionRing on_plane;
  PositionRing ring;
  for (std::size_t i = 0; i < kVertices; ++i) {
    const double x = i < kVertices / 2 ? -1'000'000 : 1'000'001;  // -180 and 10.00001 degrees
    const double y = static_cast<double>(i);
    on_plane.push_back({x, y});
    std::vector<double> lon = {x};
    std::vector<double> lat = {y};
    ASSERT_TRUE(plane.to_lonlat(lon, lat));
    ring.push_back({lon.front(), lat.front()});
  }
  const PositionRing given = ring;
  unwrap_longitudes(ring, on_plane, plane);
  EXPECT_TRUE(ring == given) << "190 degrees to the east and back, not 170 to the west";
}

}  // namespace
}  // namespace trapeze
