// All contestants on the same trip: the cost of every view for each of them, and the cost of
// preparing for the first one.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/experiment/contestant.h"

namespace trapeze::experiment {

struct RaceResult {
  Method method = Method::lifespans;
  Topology topology = Topology::strict;
  double prepare_ms = 0;
  std::size_t memory = 0;  // heap used when prepared, bytes, including that of a software device
  std::uint64_t sent_before = 0;  // to the device before the first view, bytes
  int runs = 0;
  double seconds = 0;           // of all runs
  std::vector<ViewCost> views;  // for each, the run with the median total
};

/// The difference between pictures of one scale and those of full detail.
struct PictureError {
  double scale = 0;
  std::size_t pixels = 0;    // not empty in both pictures
  double mean = 0;           // absolute difference of these, 255ths
  double share_over_64 = 0;  // share of these that differ by more than 64
  double area = 0;           // total covered area, relative to full detail, minus 1
};

struct RaceOptions {
  std::vector<Method> methods{std::begin(kMethods), std::end(kMethods)};
  int runs = 3;
  double seconds = 120;  // no run except the first starts if it would end later
};

/// A race with one setting of topology. All contestants are prepared and kept, and take turns after
/// each run, so that other load on the machine affects all of them.
class Race {
 public:
  /// Prepares the contestants. `map` and `screen` must outlive this object.
  Race(const Map& map, Topology topology, Screen& screen, std::span<const Method> methods);

  /// Runs the whole trip with all contestants, the same number of times each, except references,
  /// which run once.
  void run(std::span<const ScaledView> trip, const RaceOptions& options);

  std::vector<RaceResult> results() const;

  /// Whether the method was prepared.
  bool has(Method method) const;

  /// Draws the views with that method, which must have been prepared.
  std::vector<std::vector<Mask>> pictures(Method method, std::span<const ScaledView> views);

 private:
  struct Runner {
    std::unique_ptr<Contestant> contestant;
    RaceResult result;
    std::vector<std::vector<ViewCost>> costs;  // by view and run
  };

  void prepare(Method method, Topology topology);
  /// Returns its duration in seconds.
  double run_once(Runner& runner, std::span<const ScaledView> trip);

  const Map& map_;
  Screen& screen_;
  std::vector<Runner> runners_;
};

/// By view and layer; `views` belong to both sets of pictures and have the same scale.
PictureError compare(std::span<const ScaledView> views, std::span<const std::vector<Mask>> pictures,
                     std::span<const std::vector<Mask>> full_detail);

/// The cost of a view of that many layers without anything to draw: the median of several.
ViewCost cost_of_empty_view(std::size_t layers, Screen& screen);

/// The median; for an even number of values, the lower one of the middle two. `values` must not be
/// empty.
double median(std::vector<double> values);

}  // namespace trapeze::experiment
