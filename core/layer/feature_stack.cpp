#include "core/layer/feature_stack.h"

#include <algorithm>

namespace trapeze {

void FeatureStack::Feature::begin(std::uint32_t feature_row) {
  row = feature_row;
  role = {};
  trapezoids.clear();
  covers.clear();
  has_sheet = false;
}

bool FeatureStack::Feature::is_below(const Feature& other) const {
  return paint.is_raised == other.paint.is_raised ? row < other.row : other.paint.is_raised;
}

void FeatureStack::begin(const OverlapTable& overlaps, double narrowest) {
  overlaps_ = &overlaps;
  narrowest_ = narrowest;
  count_ = 0;
  std::ranges::fill(slots_, kNone);
  last_row_ = last_ = kNone;
}

/// The slot of the feature, or an empty one where it would be.
std::size_t FeatureStack::slot_of(std::uint32_t row) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = (row * 0x9e3779b9u) >> 8 & mask;
  while (slots_[i] != kNone && features_[slots_[i]].row != row) i = (i + 1) & mask;
  return i;
}

std::uint32_t FeatureStack::find(std::uint32_t row) const {
  if (row == last_row_) return last_;
  if (slots_.empty()) return kNone;
  const std::uint32_t number = slots_[slot_of(row)];
  if (number == kNone) return kNone;
  last_row_ = row;
  return last_ = number;
}

/// The number of a feature that is not there yet.
std::uint32_t FeatureStack::insert(std::uint32_t row) {
  if (2 * (count_ + std::size_t{1}) > slots_.size()) grow();
  if (count_ == features_.size()) features_.emplace_back();
  const std::uint32_t number = count_++;
  features_[number].begin(row);
  slots_[slot_of(row)] = number;
  last_row_ = row;
  return last_ = number;
}

void FeatureStack::grow() {
  slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), kNone);
  for (std::uint32_t number = 0; number < count_; ++number) {
    slots_[slot_of(features_[number].row)] = number;
  }
}

bool FeatureStack::settle(const Cancellation* cancellation) {
  constexpr unsigned kStepsBetweenChecks = 4096;
  CancellationCheck check(cancellation, kStepsBetweenChecks);
  bool are_all_opaque = true;
  for (std::uint32_t number = 0; number < count_; ++number) {
    are_all_opaque = are_all_opaque && features_[number].paint.is_opaque();
  }
  bool is_any_cut = false;
  for (std::uint32_t number = 0; number < count_; ++number) {
    Feature& feature = features_[number];
    for (const FeatureOverlap& overlap : overlaps_->of(feature.row)) {
      check();
      if (overlap.width < narrowest_) continue;
      const std::uint32_t other_number = find(overlap.other);
      if (other_number == kNone) continue;
      Feature& other = features_[other_number];
      const bool are_alike = are_all_opaque && other.paint.colour == feature.paint.colour;
      if (are_alike || other.paint.opacity <= 0 || !feature.is_below(other)) continue;
      feature.covers.push_back(other_number);
      feature.role = {true, true};
      other.role.is_needed = true;
      is_any_cut = true;
    }
  }
  by_row_.clear();
  for (std::uint32_t number = 0; number < count_; ++number) by_row_.push_back(number);
  std::ranges::sort(by_row_, {}, [this](std::uint32_t number) { return features_[number].row; });
  return is_any_cut;
}

FeatureStack::Role FeatureStack::role_of(std::uint32_t row) const {
  const std::uint32_t number = find(row);
  return number == kNone ? Role() : features_[number].role;
}

void FeatureStack::add(std::uint32_t row, std::uint32_t trapezoid) {
  features_[find(row)].trapezoids.push_back(trapezoid);
}

const Sheet& FeatureStack::sheet_of(const MeshView& mesh, Feature& feature) {
  if (!feature.has_sheet) feature.sheet.assign(mesh, feature.trapezoids);
  feature.has_sheet = true;
  return feature.sheet;
}

void FeatureStack::cut(const MeshView& mesh, Feature& feature, CancellationCheck& check) {
  visible_.begin(mesh, sheet_of(mesh, feature));
  for (const std::uint32_t number : feature.covers) {
    Feature& other = features_[number];
    visible_.cover(sheet_of(mesh, other), 1 - other.paint.opacity, check);
  }
}

}  // namespace trapeze
