// A layer that was built before, from which another one takes over everything built from the same
// rings: units (see built_units.h) are recognized by their digests.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/layer/built_units.h"
#include "core/layer/layer.h"
#include "core/layer/layer_arrays.h"
#include "core/layer/layer_options.h"

namespace trapeze {

/// Serves one later layer: each unit is taken over once.
///
/// Thread-safety: any number of threads may call any function.
class EarlierLayer {
 public:
  /// Indexes the layer, in a few milliseconds per hundred thousand features. The layer may be a
  /// view of a file that is truncated meanwhile: the content taken over is then wrong, but nothing
  /// is read beyond it.
  explicit EarlierLayer(std::shared_ptr<const Layer> layer);

  const Layer& layer() const { return *layer_; }
  const LayerArrays& arrays() const { return arrays_; }
  const LayerOptions& options() const { return arrays_.options; }
  BuiltUnitsView units() const { return units_.view(); }

  /// Claims a feature, or a group of so many features, of that digest that nobody has claimed yet.
  /// Returns its number among the units().
  std::optional<std::uint32_t> claim_feature(const Digest& digest);
  std::optional<std::uint32_t> claim_group(const Digest& digest, std::size_t members);

  /// What is known about the grouping of features with rings of these digests, for
  /// group_features(). `are_drawn` states that the rings drawn for a feature by itself are those by
  /// which it was grouped, so that something is known of features that were in no group.
  std::vector<std::uint32_t> known_groups(std::span<const Digest> features, bool are_drawn) const;

  /// Whether another feature has the same digest as that unit.
  bool has_double(std::uint32_t feature_unit) const { return features_.has_double(feature_unit); }

  /// By row: the first row of the graph to which the feature belongs.
  std::span<const std::uint32_t> first_rows() const { return first_rows_; }

 private:
  /// Finds units by digest. Units with the same digest are handed out one after the other.
  class Table {
   public:
    template <typename Unit>
    explicit Table(std::span<const Unit> units);

    /// The next unclaimed unit of that digest.
    template <typename Unit>
    std::optional<std::uint32_t> claim(std::span<const Unit> units, const Digest& digest);
    /// The first unit of that digest.
    template <typename Unit>
    std::optional<std::uint32_t> find(std::span<const Unit> units, const Digest& digest) const;
    /// Whether several units have the digest of that one.
    bool has_double(std::uint32_t unit) const { return has_double_[unit] != 0; }

   private:
    static constexpr std::uint32_t kNone = 0xffffffff;

    template <typename Unit>
    std::size_t slot_of(std::span<const Unit> units, const Digest& digest) const;

    // Open addressing over the first unit of each digest. The size is a power of two.
    std::vector<std::uint32_t> slots_;
    std::vector<std::uint32_t> next_;                    // by unit: the next unit of its digest
    std::vector<std::atomic<std::uint32_t>> unclaimed_;  // by first unit: the next to be claimed
    std::vector<std::uint8_t> has_double_;               // by unit
  };

  void find_first_rows();

  const std::shared_ptr<const Layer> layer_;
  const LayerArrays arrays_;
  const BuiltUnits units_;  // a private copy, never changed
  Table features_;
  Table groups_;
  Table members_;
  std::vector<std::uint32_t> first_rows_;
  std::vector<bool> is_member_;  // by row: whether it belongs to a group
};

}  // namespace trapeze
