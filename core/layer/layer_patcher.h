// Makes one state of a layer after the other in a time that goes by what changed, not by what there
// is: for sources that tell which of their features are others now.
//
// States share the arrays of the mesh, which only grow: what is new is appended, as a segment with
// indexes of its own, and the trapezoids of what it replaces get a lifespan that is over before it
// begins. Whole units (see built_units.h) are replaced, so that what is drawn of polygons is what
// would be drawn if the layer were built anew. The dust of what was replaced is taken away where it
// had not been merged with that of others, and made up for by motes of negative area where it had:
// the area is right at every level, but may lie off by a part of a pixel.
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

/// One thread at a time. States, once made, are layers like others: any number of threads may read
/// them, also while the next one is made.
class LayerPatcher {
 public:
  /// Copies the layer, which was built whole, in a time by its size. Throws std::invalid_argument
  /// if two of its features have one id.
  explicit LayerPatcher(const Layer& whole);
  ~LayerPatcher();
  LayerPatcher(LayerPatcher&&) noexcept;
  LayerPatcher& operator=(LayerPatcher&&) noexcept;

  /// The layer as it was given, from which a later one may take over (see EarlierLayer).
  const std::shared_ptr<const Layer>& first() const;
  /// The state of now.
  const std::shared_ptr<const Layer>& now() const;
  /// How many times apply() has been called since the first state; each makes drawing a little
  /// slower.
  std::size_t patches() const;

  /// Which features have to be built anew if those of `ids` change, appear or go, and what they
  /// become, or come near to, lies in `places`: the ids of units that change or that `places` come
  /// within `reach` cells of, and the `ids` themselves. In order of rows, those that are new last.
  std::vector<std::int64_t> ids_to_build(std::span<const std::int64_t> ids,
                                         std::span<const Box> places, double reach) const;

  struct Patch {
    /// As ids_to_build() said.
    std::span<const std::int64_t> ids;
    /// All of them that there are now, with their attributes, in that order, built as the whole
    /// layer was. The fields are those of the layer.
    const Layer& features;
  };
  /// Makes the next state, and returns where it may look different. A feature that was there before
  /// keeps its row; new ones come after all others. Throws std::length_error, and changes nothing,
  /// if there are more of anything than 32 bits count; std::invalid_argument, likewise, if the
  /// fields are others or two features have one id; std::bad_alloc, after which nothing more can
  /// be applied.
  LayerChanges apply(const Patch& patch);

  /// Goes back to the first state, as if nothing had been applied. What has been appended stays
  /// where it is, as states that are in use look at it.
  void start_over();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
