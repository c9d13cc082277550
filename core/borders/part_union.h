// The union of the parts of a feature where they overlap.
//
// Inside is even-odd over all rings of a feature, so neither their order nor their direction has to
// be right. But a part that occurs twice would cancel itself, and an overlap of two parts would be
// a hole. So overlapping parts are united first.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/grid/rings.h"

namespace trapeze {

/// What unite_parts() found.
struct PartUnion {
  bool did_overlap = false;  // some of the parts covered the same place
  std::string failure;       // why they are not united although they did, empty otherwise
};

/// Part i consists of the rings part_ends[i - 1] .. part_ends[i] - 1, even-odd. If parts overlap,
/// `rings` become the rings of their union, which are clean (see clean_rings.h). Otherwise, or if
/// that fails, they stay unchanged. Unless parts meet, this takes a small fraction of the time
/// needed to build a graph of the rings.
PartUnion unite_parts(Rings& rings, std::span<const std::uint32_t> part_ends);

}  // namespace trapeze
