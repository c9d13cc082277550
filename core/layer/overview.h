// The overview of a layer that is in several parts: what of them is left at coarse levels, as one
// layer, so that a picture of the whole world need not look at every part.
//
// Polygons and outlines are those of the parts. So is dust, feature by feature, that comes to be at
// these levels; what came to be before is there as motes, which the parts have merged already, and
// which are merged here across parts. They are as large as those of the layer as a whole but for
// the rounding of their sides to cells, and lie within the same pixel, but not always at the same
// place in it. Attributes and outlines at full detail are left out: the overview is for what
// draws all features alike.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/adapt/history.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Takes the parts one after the other, so that no more than one of them need be there. One thread
/// at a time.
class OverviewBuilder {
 public:
  /// The level from which on the overview is one.
  explicit OverviewBuilder(Level first_level);
  ~OverviewBuilder();
  OverviewBuilder(const OverviewBuilder&) = delete;
  OverviewBuilder& operator=(const OverviewBuilder&) = delete;

  /// A layer that was built whole. Throws std::length_error if there is more of anything together
  /// than 32 bits count.
  void add(const Layer& part);

  /// On up to `threads` threads, on which nothing depends.
  std::unique_ptr<Layer> finish(unsigned threads = 1);

 private:
  class Adding;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
