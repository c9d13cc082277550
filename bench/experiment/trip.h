// The trip: consecutive views of a map, zooming in step by step, with pans between, and back out.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/experiment/contestant.h"

namespace trapeze::experiment {

/// The standardized size of a pixel (OGC), metres: what makes a scale of a resolution.
constexpr double kPixelMetres = 0.00028;

struct TripOptions {
  std::uint32_t seed = 1;
  double simplify_pixels = 0.25;  // tolerance asked for; the nearest level of the ladder is taken
};

/// The view of that scale around a point.
ScaledView view_around(const Map& map, Point centre, double scale, int width, int height,
                       double simplify_pixels);

/// 72 views, from the whole map's scale to the closest and back: nine scales each way, with three
/// pans at each. What is zoomed in to and panned to is a vertex in the view, chosen by the seed.
std::vector<ScaledView> plan_trip(const Map& map, const TripOptions& options);

/// The five scales of the paper's Figure 7, in shares of the smallest scale.
constexpr double kFigureScales[] = {1.0, 80.0 / 250, 50.0 / 250, 29.0 / 250, 3.0 / 250};

}  // namespace trapeze::experiment
