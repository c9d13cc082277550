// Whether two programs make the same layer from the same source.
#pragma once

#include <cstdint>

#include "core/layer/layer_options.h"

namespace trapeze {

/// A number that is equal wherever layers are built alike: with these options, on the same grid,
/// with the same tolerances, by the same method. It is the checksum of a small layer built for this
/// purpose (in about a millisecond), so no change to the method can be forgotten. Changes in how
/// sources are read, and in the revision under which a layer is saved, are covered by
/// kReadingVersion. Equal on every machine.
std::uint64_t build_fingerprint(const LayerOptions& options);

}  // namespace trapeze
