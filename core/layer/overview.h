// The overview of a layer in several parts: everything that remains of them at coarse levels, as
// one layer, so that an image of the whole world need not read every part.
//
// Polygons and outlines are those of the parts. So is the dust, feature by feature, that arises at
// these levels. Dust that arose earlier is present as motes, which the parts have already merged
// and which are merged here across parts. Their sizes equal those in an undivided layer, except for
// the rounding of their sides to cells, and they lie within the same pixel, but not always at the
// same place in it. Attributes and outlines at full detail are left out: the overview serves
// drawing that treats all features alike.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/adapt/history.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Takes the parts one after the other, so only one of them has to be loaded at a time. One thread
/// at a time.
class OverviewBuilder {
 public:
  /// The overview starts at `first_level` and covers all coarser levels.
  explicit OverviewBuilder(Level first_level);
  ~OverviewBuilder();
  OverviewBuilder(const OverviewBuilder&) = delete;
  OverviewBuilder& operator=(const OverviewBuilder&) = delete;

  /// Adds a layer that was built whole. Throws std::length_error if there are more items of any
  /// kind in total than 32 bits can count.
  void add(const Layer& part);

  /// Runs on up to `threads` threads; the result does not depend on their number.
  std::unique_ptr<Layer> finish(unsigned threads = 1);

 private:
  class Adding;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
