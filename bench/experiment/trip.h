// The trip: consecutive views of a map, zooming in step by step, with pans in between, and back
// out.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/experiment/contestant.h"

namespace trapeze::experiment {

/// The standardized pixel size (OGC), in metres, which relates scale and resolution.
constexpr double kPixelMetres = 0.00028;

struct TripOptions {
  std::uint32_t seed = 1;
  double simplify_pixels = 0.25;  // requested tolerance; the nearest level of the ladder is used
};

/// The view of that scale around a point.
ScaledView view_around(const Map& map, Point centre, double scale, int width, int height,
                       double simplify_pixels);

/// 72 views, from the scale of the whole map to the closest and back: nine scales each way, with
/// three pans at each. The targets of zooming and panning are vertices in the view, chosen by the
/// seed.
std::vector<ScaledView> plan_trip(const Map& map, const TripOptions& options);

/// The five scales of the paper's Figure 7, as shares of the smallest scale.
constexpr double kFigureScales[] = {1.0, 80.0 / 250, 50.0 / 250, 29.0 / 250, 3.0 / 250};

}  // namespace trapeze::experiment
