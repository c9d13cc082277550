// Trapeze: all versions of all trapezoids are on the device from the beginning, and a view selects
// those that are alive at its tolerance, either with dust or, like the other contestants, without
// features too small for the tolerance. Also, for reference, full detail in every view.
#pragma once

#include <memory>
#include <vector>

#include "bench/experiment/contestant.h"

namespace trapeze::experiment {

class Lifespans final : public Contestant {
 public:
  /// `method` is one of lifespans, lifespans_and_dust, no_simplification.
  Lifespans(Method method, Topology topology, const Map& map, Screen& screen);
  ~Lifespans() override;

  std::uint64_t sent_before() const override;
  ViewCost draw(const ScaledView& view, std::vector<Mask>& masks) override;

 private:
  Layer::Selection selection_of(const ScaledView& view) const;

  Screen& screen_;
  const Method method_;
  std::vector<std::unique_ptr<Layer>> layers_;
  std::vector<MeshView> meshes_;  // by layer
  std::vector<Ranges> ranges_;    // by layer
};

}  // namespace trapeze::experiment
