// Places and colours in pictures that a SampleSite answers with.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "render/picture/picture.h"
#include "render/picture/png.h"
#include "tests/server/service/sample_site.h"

namespace trapeze::testing {

/// Cells in a pixel of the tile of zoom 0.
constexpr double kPixel = 1 << 23;

/// In pixels of the tile of zoom 0.
struct Place {
  double x = 0;
  double y = 0;
};
using Ring = std::vector<Place>;

/// The coordinate of a point that many pixels of the tile of zoom 0 from the border.
inline std::int32_t cell(double pixels) {
  return static_cast<std::int32_t>(kGridMin + pixels * kPixel);
}

/// In pixels of the tile of zoom 0.
inline Point point_at(double x, double y) {
  return {cell(x), cell(y)};
}

/// A rectangle, in pixels of the tile of zoom 0.
inline Rings box(double west, double north, double east, double south) {
  Rings rings;
  rings.add(std::vector<Point>{{cell(west), cell(north)},
                               {cell(east), cell(north)},
                               {cell(east), cell(south)},
                               {cell(west), cell(south)}});
  return rings;
}

/// The picture at that target; a missing one fails the test and gives an empty picture.
inline Picture picture_of(SampleSite& site, const std::string& target) {
  const HttpResponse response = site.get(target);
  EXPECT_EQ(response.status, 200) << target << " " << (response.body ? *response.body : "");
  return response.status == 200 ? decode_png(*response.body) : Picture();
}

/// Compares the channels; if the pixel should be transparent, just the opacity.
inline void expect_near(Rgba actual, Rgba expected, int tolerance) {
  EXPECT_NEAR(actual.a, expected.a, tolerance);
  if (expected.a == 0) return;
  EXPECT_NEAR(actual.r, expected.r, tolerance);
  EXPECT_NEAR(actual.g, expected.g, tolerance);
  EXPECT_NEAR(actual.b, expected.b, tolerance);
}

}  // namespace trapeze::testing
