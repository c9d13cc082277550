#include "core/layer/earlier_layer.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/borders/coverage_groups.h"

namespace trapeze {
namespace {

/// If the file of the layer is truncated, the missing part reads as zero: its groups then have no
/// members.
BuiltUnits copy_of(const BuiltUnitsView& from) {
  BuiltUnits to;
  const auto copy = [](const auto& items, auto& copied) {
    copied.assign(items.begin(), items.end());
  };
  copy(from.features, to.features);
  copy(from.groups, to.groups);
  copy(from.members, to.members);
  copy(from.overlaps, to.overlaps);
  std::uint32_t members = 0;
  std::uint32_t overlaps = 0;
  for (GroupUnit& group : to.groups) {
    group.members_end = members = std::max(members, group.members_end);
    group.overlaps_end = overlaps = std::max(overlaps, group.overlaps_end);
  }
  return to;
}

}  // namespace

template <typename Unit>
EarlierLayer::Table::Table(std::span<const Unit> units)
    : slots_(std::bit_ceil(2 * units.size() + 1), kNone),
      next_(units.size(), kNone),
      unclaimed_(units.size()),
      has_double_(units.size()) {
  std::vector<std::uint32_t> last(units.size());  // by first unit
  for (std::uint32_t i = 0; i < units.size(); ++i) {
    unclaimed_[i] = last[i] = i;
    std::uint32_t& first = slots_[slot_of(units, units[i].digest)];
    if (first == kNone) {
      first = i;
      continue;
    }
    next_[last[first]] = i;
    last[first] = i;
    has_double_[first] = has_double_[i] = 1;
  }
}

/// The slot of the first unit of the digest, or the one where it would be.
template <typename Unit>
std::size_t EarlierLayer::Table::slot_of(std::span<const Unit> units, const Digest& digest) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = digest.low & mask;
  while (slots_[i] != kNone && units[slots_[i]].digest != digest) i = (i + 1) & mask;
  return i;
}

template <typename Unit>
std::optional<std::uint32_t> EarlierLayer::Table::find(std::span<const Unit> units,
                                                       const Digest& digest) const {
  const std::uint32_t first = slots_[slot_of(units, digest)];
  return first == kNone ? std::nullopt : std::optional(first);
}

template <typename Unit>
std::optional<std::uint32_t> EarlierLayer::Table::claim(std::span<const Unit> units,
                                                        const Digest& digest) {
  const std::uint32_t first = slots_[slot_of(units, digest)];
  if (first == kNone) return std::nullopt;
  std::atomic<std::uint32_t>& next = unclaimed_[first];
  std::uint32_t unit = next;
  while (unit != kNone && !next.compare_exchange_weak(unit, next_[unit])) {
  }
  return unit == kNone ? std::nullopt : std::optional(unit);
}

EarlierLayer::EarlierLayer(std::shared_ptr<const Layer> layer)
    : layer_(std::move(layer)),
      arrays_(arrays_of(*layer_)),
      units_(copy_of(arrays_.units)),
      features_(units().features),
      groups_(units().groups),
      members_(units().members) {
  find_first_rows();
}

void EarlierLayer::find_first_rows() {
  first_rows_.resize(arrays_.cells.ids.size());
  std::iota(first_rows_.begin(), first_rows_.end(), 0u);
  is_member_.resize(first_rows_.size());
  for (const GroupMember& member : units_.members) is_member_[member.row] = true;
  for (std::size_t g = 0; g < units_.groups.size(); ++g) {
    std::optional<std::uint32_t> first;
    for (const GroupMember& member : units().members_of(g)) {
      if (member.is_apart != 0) continue;
      if (!first) first = member.row;
      // In a truncated file the rows may not ascend.
      first_rows_[member.row] = std::min(*first, member.row);
    }
  }
}

/// A group is known if all its features exist. Which of several features with the same rings is
/// found does not matter, because they are tied to the same others.
std::vector<std::uint32_t> EarlierLayer::known_groups(std::span<const Digest> features,
                                                      bool are_drawn) const {
  std::vector<std::uint32_t> group_of(units_.members.size());
  for (std::uint32_t g = 0; g < units_.groups.size(); ++g) {
    const std::size_t end = units_.groups[g].members_end;
    const std::size_t begin = end - units().members_of(g).size();
    std::fill(group_of.begin() + static_cast<std::ptrdiff_t>(begin),
              group_of.begin() + static_cast<std::ptrdiff_t>(end), g);
  }
  std::vector<std::uint32_t> known(features.size(), kUnknownGroup);
  std::vector<bool> is_there(units_.members.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (const auto member = members_.find(units().members, features[i])) {
      is_there[*member] = true;
      known[i] = group_of[*member];
    } else if (const auto unit = features_.find(units().features, features[i]);
               unit && are_drawn && !is_member_[units_.features[*unit].row]) {
      known[i] = static_cast<std::uint32_t>(units_.groups.size()) + *unit;
    }
  }
  std::vector<bool> is_broken(units_.groups.size());
  for (std::size_t m = 0; m < units_.members.size(); ++m) {
    const auto first = members_.find(units().members, units_.members[m].digest);
    if (!is_there[*first]) is_broken[group_of[m]] = true;
  }
  for (std::uint32_t& group : known) {
    if (group < is_broken.size() && is_broken[group]) group = kUnknownGroup;
  }
  return known;
}

std::optional<std::uint32_t> EarlierLayer::claim_feature(const Digest& digest) {
  return features_.claim(units().features, digest);
}

std::optional<std::uint32_t> EarlierLayer::claim_group(const Digest& digest, std::size_t members) {
  const std::optional<std::uint32_t> unit = groups_.claim(units().groups, digest);
  if (!unit || units().members_of(*unit).size() != members) return std::nullopt;
  return unit;
}

}  // namespace trapeze
