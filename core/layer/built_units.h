// What a layer keeps about how it was built, so that a later layer can take over everything
// unchanged (see earlier_layer.h). A unit is built as a whole: a feature by itself, or a group of a
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

/// The stored form of an optional tolerance in cells.
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

/// A feature that was built by itself, with its outcome; see BuildOutcome.
struct FeatureUnit {
  Digest digest;  // of its rings as given to the builder
  StoredTolerance most_tolerance;
  std::uint32_t row = 0;
  std::uint32_t vertices = 0;
  std::uint32_t collapsed_rings = 0;
  std::uint32_t is_noded = 0;
};

/// Instead of the digest of a group that failed: nobody claims it. All its features are apart.
constexpr Digest kOfFailedGroup = {};

/// A group of a coverage, with its outcome; see CoverageOutcome.
struct GroupUnit {
  Digest digest;  // of the digests of its features, in order; or kOfFailedGroup
  StoredTolerance most_tolerance;
  std::uint32_t members_end = 0;   // one past its last feature among the members
  std::uint32_t overlaps_end = 0;  // one past its last pair among the overlaps
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
  Digest digest;  // of its rings as used for grouping
  std::uint32_t row = 0;
  std::uint32_t is_apart = 0;  // not in the graph of the group, but a unit by itself
};

/// Two features of a group that overlap, by their positions in it.
struct GroupOverlap {
  std::uint32_t lower = 0;
  std::uint32_t upper = 0;
  std::uint64_t area = 0;        // of the overlap: the bits of a double, cells squared
  std::uint64_t lower_area = 0;  // the same, of the whole lower feature
};

/// Views of memory owned by others.
struct BuiltUnitsView {
  std::span<const FeatureUnit> features;   // in order of rows
  std::span<const GroupUnit> groups;       // in order of their first rows
  std::span<const GroupMember> members;    // of each group in order of rows
  std::span<const GroupOverlap> overlaps;  // of each group, in the order found

  /// The members of a group; its indices must lie within the members and overlaps.
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

/// Digest of the rings of a feature.
Digest digest_of(const Rings& rings);
/// Digest of a feature of a class, with rings of that digest.
Digest digest_of(const Digest& rings, std::uint64_t own_class);
/// Digest of a group of features with these digests. Never equals that of a single feature.
Digest digest_of(std::span<const Digest> features);

}  // namespace trapeze
