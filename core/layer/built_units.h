// What a layer keeps of how it was built, so that a later one can take over what has not changed
// (see earlier_layer.h). A unit is what is built at once: a feature by itself, or a group of a
// coverage.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/grid/digest.h"
#include "core/grid/rings.h"

namespace trapeze {

/// A tolerance in cells, or none, as it is stored.
struct StoredTolerance {
  std::uint64_t bits = kNone;

  StoredTolerance() = default;
  explicit StoredTolerance(std::optional<double> tolerance)
      : bits(tolerance ? std::bit_cast<std::uint64_t>(*tolerance) : kNone) {}
  std::optional<double> get() const {
    if (bits == kNone) return std::nullopt;
    return std::bit_cast<double>(bits);
  }

  static constexpr std::uint64_t kNone = 0xffffffffffffffff;
};

/// A feature that was built by itself, and what became of it; see BuildOutcome.
struct FeatureUnit {
  Digest digest;  // of its rings as they were given to the builder
  StoredTolerance most_tolerance;
  std::uint32_t row = 0;
  std::uint32_t vertices = 0;
  std::uint32_t collapsed_rings = 0;
  std::uint32_t is_noded = 0;
};

/// A group of a coverage, and what became of it; see CoverageOutcome. One that failed is not kept.
struct GroupUnit {
  Digest digest;  // of the digests of its features in their order
  StoredTolerance most_tolerance;
  std::uint32_t members_end = 0;   // where its features end among the members
  std::uint32_t overlaps_end = 0;  // where its pairs end among the overlaps
  std::uint32_t vertices = 0;
  std::uint32_t shared_edges = 0;
  std::uint32_t junctions = 0;
  std::uint32_t gaps = 0;
  std::uint32_t filled = 0;
  std::uint16_t is_noded = 0;
  std::uint16_t is_crowded = 0;
};

/// A feature of a group.
struct GroupMember {
  Digest digest;  // of its rings as they were grouped
  std::uint32_t row = 0;
  std::uint32_t is_apart = 0;  // not in the graph of the group, but a unit by itself
};

/// Two features of a group that overlap, by their positions in it.
struct GroupOverlap {
  std::uint32_t lower = 0;
  std::uint32_t upper = 0;
  std::uint64_t area = 0;        // of what they have in common: the bits of a double, cells squared
  std::uint64_t lower_area = 0;  // likewise, of the whole lower feature
};

/// Views of memory that something else owns.
struct BuiltUnitsView {
  std::span<const FeatureUnit> features;   // in order of rows
  std::span<const GroupUnit> groups;       // in order of their first rows
  std::span<const GroupMember> members;    // of each group in order of rows
  std::span<const GroupOverlap> overlaps;  // of each group as they were found

  /// Of the groups, which must lead into the members and overlaps.
  std::span<const GroupMember> members_of(std::size_t group) const {
    const std::size_t begin = group == 0 ? 0 : groups[group - 1].members_end;
    return members.subspan(begin, groups[group].members_end - begin);
  }
  std::span<const GroupOverlap> overlaps_of(std::size_t group) const {
    const std::size_t begin = group == 0 ? 0 : groups[group - 1].overlaps_end;
    return overlaps.subspan(begin, groups[group].overlaps_end - begin);
  }
};

struct BuiltUnits {
  std::vector<FeatureUnit> features;
  std::vector<GroupUnit> groups;
  std::vector<GroupMember> members;
  std::vector<GroupOverlap> overlaps;

  BuiltUnitsView view() const { return {features, groups, members, overlaps}; }
};

/// Of the rings of a feature.
Digest digest_of(const Rings& rings);
/// Of a feature of a class with rings of that digest.
Digest digest_of(const Digest& rings, std::uint64_t own_class);
/// Of a group of features with these digests. Never that of a single feature.
Digest digest_of(std::span<const Digest> features);

}  // namespace trapeze
