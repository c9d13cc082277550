// Whether two programs make the same layer of the same source.
#pragma once

#include <cstdint>

#include "core/layer/layer_options.h"

namespace trapeze {

/// A number that is the same wherever layers are built alike: with these options, on the same grid,
/// with the same tolerances, by the same method. It is the checksum of a small layer that is built
/// for the purpose (in about a millisecond), so that no change to the method can be forgotten; what
/// is read from a source, and under which revision it is saved, is counted by kReadingVersion.
/// Equal on every machine.
std::uint64_t build_fingerprint(const LayerOptions& options);

}  // namespace trapeze
