// Makes successive states of a layer in a time proportional to the changes, not to the size of the
// layer: for sources that report which of their features have changed.
//
// States share the arrays of the mesh, which only grow. New content is appended as a segment with
// its own indexes, and the trapezoids that it replaces get a lifespan that ends before it begins.
// Whole units (see built_units.h) are replaced, so polygons are drawn exactly as if the whole layer
// were rebuilt. Dust of replaced units is removed if it had not been merged with that of others,
// and otherwise compensated by motes of negative area: the area is right at every level, but may be
// off in position by a fraction of a pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/layer/layer.h"
#include "core/layer/layer_changes.h"

namespace trapeze {

/// One thread at a time. States, once made, are ordinary layers: any number of threads may read
/// them, even while the next one is made.
class LayerPatcher {
 public:
  /// Copies the layer, which was built whole, in a time that depends on its size. Throws
  /// std::invalid_argument if two of its features have the same id.
  explicit LayerPatcher(const Layer& whole);
  ~LayerPatcher();
  LayerPatcher(LayerPatcher&&) noexcept;
  LayerPatcher& operator=(LayerPatcher&&) noexcept;

  /// The original layer, from which a later one may take over content (see EarlierLayer).
  const std::shared_ptr<const Layer>& first() const;
  /// The current state.
  const std::shared_ptr<const Layer>& now() const;
  /// How many times apply() has been called since the first state. Each call makes drawing a little
  /// slower.
  std::size_t patches() const;

  /// The features that must be rebuilt if those of `ids` are changed, added or removed, and
  /// `places` contains the new geometries and those that they come near to: the `ids` themselves,
  /// and the ids of units that change or that lie within `reach` cells of `places`. In order of
  /// rows, new ones last.
  std::vector<std::int64_t> ids_to_build(std::span<const std::int64_t> ids,
                                         std::span<const Box> places, double reach) const;

  struct Patch {
    /// The result of ids_to_build().
    std::span<const std::int64_t> ids;
    /// All of them that exist now, with their attributes, in that order, built like the whole
    /// layer. The fields are those of the layer.
    const Layer& features;
  };
  /// Makes the next state and returns where it may look different. Existing features keep their
  /// rows; new ones come after all others. Throws std::length_error if there are more items of any
  /// kind than 32 bits can count, and std::invalid_argument if the fields differ or two features
  /// have the same id; both leave the state unchanged. Throws std::bad_alloc, after which no more
  /// patches can be applied.
  LayerChanges apply(const Patch& patch);

  /// Returns to the first state, as if nothing had been applied. Appended content stays in place,
  /// because states in use refer to it.
  void start_over();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
