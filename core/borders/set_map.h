// The subdivision of the plane by the sets of features that cover it.
//
// All rings are noded together. The sweep knows which features cover each face: crossing an edge
// toggles the features that own it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/rings.h"
#include "core/sweep/boundary.h"
#include "core/sweep/noding.h"
#include "core/sweep/trapezoidation.h"

namespace trapeze {

/// Numbers for small sets of features, each in ascending order; 0 is the empty set. Once the sets
/// have more than kMostMembers members in total, every new set is the empty one.
class FeatureSets {
 public:
  explicit FeatureSets(std::size_t features) : of_one_(features, kUnknown) { number({}); }

  std::uint32_t number(const std::vector<std::uint32_t>& features);
  std::uint32_t number_of_one(std::uint32_t feature);
  /// Whether that limit has been exceeded: sets numbered since then are meaningless.
  bool is_full() const { return members_ > kMostMembers; }
  std::size_t size() const { return sets_.size(); }
  const std::vector<std::uint32_t>& operator[](std::uint32_t number) const { return sets_[number]; }

  /// The features that are in one of two sets and not in the other.
  std::uint32_t toggled(std::uint32_t a, std::uint32_t b);

 private:
  static constexpr std::size_t kMostMembers = std::size_t{1} << 23;  // kept twice: 64 MiB
  static constexpr std::uint32_t kUnknown = 0xffffffff;

  std::map<std::vector<std::uint32_t>, std::uint32_t> numbers_;
  std::vector<std::vector<std::uint32_t>> sets_;
  std::vector<std::uint32_t> of_one_;  // the number of the set of a feature alone
  std::size_t members_ = 0;
  std::unordered_map<std::uint64_t, std::uint32_t> toggled_;
};

/// Distinct segments in order of place (see owned_segments.h), and for each the set of features
/// whose boundary it belongs to.
struct Borders {
  std::vector<Segment> segments;
  std::vector<std::uint32_t> owners;
};

/// Features are given by position. One thread at a time.
class SetMap {
 public:
  static constexpr const char* kTooManyOverEachOther = "too many of them overlap";

  /// Each feature is defined by even-odd of its own rings, which are clean (see clean_rings.h).
  /// Works on up to `threads` threads; the subdivision does not depend on their number.
  explicit SetMap(std::span<const Rings* const> features, unsigned threads = 1);

  /// Makes `graph` the subdivision: its edges are those of borders(), and a face is the number of a
  /// set. False if nothing is left, or on failure. With hot vertices, vertices that lie beside
  /// edges but within a cell of them also become a part of them.
  bool sweep(Boundary& boundary, Trapezoidation& trapezoidation, TrapezoidalGraph& graph,
             HotCells cells = HotCells::crossings);

  const FeatureSets& sets() const { return sets_; }
  const Borders& borders() const { return borders_; }
  /// Whether vertices were missing on one side of a border, or borders crossed.
  bool is_noded() const { return is_noded_; }
  /// Why the last sweep failed; empty if it did not fail.
  const std::string& failure() const { return failure_; }

 private:
  bool node_borders(const Boundary& boundary, HotCells cells);
  void fail_to_node();

  unsigned threads_;
  FeatureSets sets_;
  Borders borders_;
  bool is_noded_ = false;
  std::string failure_;
};

}  // namespace trapeze
