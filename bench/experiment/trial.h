// A contestant on its trip: what every view costs, and what it takes to be ready for the first one.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bench/experiment/contestant.h"

namespace trapeze::experiment {

struct TrialResult {
  Method method = Method::lifespans;
  Topology topology = Topology::strict;
  double prepare_ms = 0;
  std::size_t memory = 0;      // heap held while it is ready, bytes; llvmpipe's is the heap, too
  std::uint64_t sent_before = 0;  // to the device before the first view, bytes
  std::vector<ViewCost> views;  // of each, that of the run of median total
};

/// `runs` times the whole trip, on an odd number of runs.
TrialResult run_trial(Method method, Topology topology, const Map& map,
                      std::span<const ScaledView> trip, int runs, Screen& screen);

/// What drawing costs if there is nothing to draw: the median over as many views of as many layers.
double empty_view_ms(std::size_t layers, Screen& screen);

/// The median; of an even number of values the lower of the two in the middle. Not empty.
double median(std::vector<double> values);

}  // namespace trapeze::experiment
