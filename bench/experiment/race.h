// All contestants on the same trip: what every view costs each of them, and what it takes to be
// ready for the first one.
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
  std::size_t memory = 0;  // heap held when it is ready, bytes; that of a software device is heap
  std::uint64_t sent_before = 0;  // to the device before the first view, bytes
  int runs = 0;
  double seconds = 0;           // that all runs took
  std::vector<ViewCost> views;  // of each, that of the run of median total
};

/// What pictures of one scale are off those of full detail.
struct PictureError {
  double scale = 0;
  std::size_t pixels = 0;    // that are not empty in both pictures
  double mean = 0;           // absolute difference of these, 255ths
  double share_over_64 = 0;  // of these, those off by more than 64
  double area = 0;           // covered in all, relative to full detail, less 1
};

struct RaceOptions {
  std::vector<Method> methods{std::begin(kMethods), std::end(kMethods)};
  int runs = 3;
  double seconds = 120;  // runs that would end later than this are not begun, but for the first
};

/// With one treatment of topology. All contestants are prepared and stay so, and take turns run by
/// run, so that whatever else the machine does hits all of them.
class Race {
 public:
  /// Prepares the contestants. `map` and `screen` must outlive this.
  Race(const Map& map, Topology topology, Screen& screen, std::span<const Method> methods);

  /// Goes on the whole trip with each, as often with one as with the other; with those that are
  /// there for reference once.
  void run(std::span<const ScaledView> trip, const RaceOptions& options);

  std::vector<RaceResult> results() const;

  /// Whether that method was prepared.
  bool has(Method method) const;

  /// Draws the views with that method, which was prepared.
  std::vector<std::vector<Mask>> pictures(Method method, std::span<const ScaledView> views);

 private:
  struct Runner {
    std::unique_ptr<Contestant> contestant;
    RaceResult result;
    std::vector<std::vector<ViewCost>> costs;  // by view and run
  };

  void prepare(Method method, Topology topology);
  /// Returns the seconds that it took.
  double run_once(Runner& runner, std::span<const ScaledView> trip);

  const Map& map_;
  Screen& screen_;
  std::vector<Runner> runners_;
};

/// By view and layer; `views` are those of both, all of one scale.
PictureError compare(std::span<const ScaledView> views, std::span<const std::vector<Mask>> pictures,
                     std::span<const std::vector<Mask>> full_detail);

/// What a view of that many layers costs if there is nothing to draw: the median of several.
ViewCost cost_of_empty_view(std::size_t layers, Screen& screen);

/// The median; of an even number of values the lower of the two in the middle. Not empty.
double median(std::vector<double> values);

}  // namespace trapeze::experiment
