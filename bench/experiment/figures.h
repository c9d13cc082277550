// The paper's Figure 7: a map at five scales, and its adapted meshes.
#pragma once

#include <string>
#include <vector>

#include "bench/experiment/contestant.h"

namespace trapeze::experiment {

/// Writes MAP-1.png to MAP-5.png, and MAP-1-mesh.png to MAP-5-mesh.png, the centres of the trip's
/// views at the five scales, into `folder`. Returns the file names. Throws std::runtime_error if
/// one cannot be written.
std::vector<std::string> draw_figures(const Map& map, const std::vector<ScaledView>& trip,
                                      const std::string& folder, Screen& screen);

/// The views of the trip at a scale of Figure 7: the first one on the way in, and the first one on
/// the way back.
std::vector<ScaledView> views_of_scale(const std::vector<ScaledView>& trip, double scale);

}  // namespace trapeze::experiment
