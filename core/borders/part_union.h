// The union of the parts of a feature, where they lie over each other.
//
// Inside is even-odd over all rings of a feature, so that neither their order nor their direction
// has to be right. A part that is there twice would cancel itself, and what two parts cover would
// be a hole. So parts that overlap are united before.
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
/// `rings` become the rings of their union, which are clean (see clean_rings.h); else they remain
/// as they are, as they do if that fails. Takes a small share of the time that it takes to build a
/// graph of the rings, unless parts meet.
PartUnion unite_parts(Rings& rings, std::span<const std::uint32_t> part_ends);

}  // namespace trapeze
