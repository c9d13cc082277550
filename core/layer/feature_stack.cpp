#include "core/layer/feature_stack.h"

#include <algorithm>
#include <utility>

namespace trapeze {

void FeatureStack::Feature::begin(std::uint32_t feature_row) {
  row = feature_row;
  box = {};
  is_in_a_pair = false;
  is_over_others = false;
  covers.clear();
  trapezoids.clear();
  below.clear();
  has_sheet = false;
}

bool FeatureStack::Feature::is_below(const Feature& other) const {
  return paint.is_raised == other.paint.is_raised ? row < other.row : other.paint.is_raised;
}

void FeatureStack::begin(const OverlapTable& overlaps, const MeshView& mesh,
                         const Options& options) {
  overlaps_ = &overlaps;
  mesh_ = mesh;
  options_ = options;
  count_ = 0;
  std::ranges::fill(slots_, kNone);
  last_noted_ = last_row_ = last_ = kNone;
}

/// A box that contains the trapezoid: of the same height, and as wide as its sides from end to end.
Box FeatureStack::box_around(std::uint32_t trapezoid) const {
  const MeshTrapezoid& t = mesh_.trapezoids[trapezoid];
  const MeshEdge left = mesh_.edges[t.left];
  const MeshEdge right = mesh_.edges[t.right];
  return {std::min(mesh_.vertices[left.upper].x, mesh_.vertices[left.lower].x),
          mesh_.vertices[t.top].y,
          std::max(mesh_.vertices[right.upper].x, mesh_.vertices[right.lower].x),
          mesh_.vertices[t.bottom].y};
}

/// The slot of the feature, or the empty one where it would be.
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

/// Inserts a feature that does not exist yet and returns its number.
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

bool FeatureStack::find_covers(const Cancellation* cancellation) {
  constexpr unsigned kStepsBetweenChecks = 4096;
  CancellationCheck check(cancellation, kStepsBetweenChecks);
  // Features that overlap others only elsewhere do not count: an edit there must not change what is
  // drawn here.
  const auto overlaps_any_here = [this](const Feature& feature) {
    return std::ranges::any_of(overlaps_->of(feature.row), [this](const FeatureOverlap& overlap) {
      return find(overlap.other) != kNone;
    });
  };
  bool are_all_opaque = true;
  for (std::uint32_t number = 0; number < count_ && are_all_opaque; ++number) {
    const Feature& feature = features_[number];
    are_all_opaque = feature.paint.is_opaque() || !overlaps_any_here(feature);
  }
  covers_in_common_ = !are_all_opaque || options_.cuts_whole_features;
  bool are_any = false;
  for (std::uint32_t number = 0; number < count_; ++number) {
    Feature& feature = features_[number];
    for (const FeatureOverlap& overlap : overlaps_->of(feature.row)) {
      check();
      if (overlap.width < options_.narrowest) continue;
      if (overlap.is_in_common() && !covers_in_common_) continue;
      const std::uint32_t other_number = find(overlap.other);
      if (other_number == kNone) continue;
      Feature& other = features_[other_number];
      const bool are_alike = are_all_opaque && other.paint.colour == feature.paint.colour;
      if (are_alike && options_.is_fine && overlap.along == 0) continue;
      if (other.paint.opacity <= 0 || !feature.is_below(other)) continue;
      feature.covers.push_back(other_number);
      feature.is_in_a_pair = other.is_in_a_pair = true;
      are_any = true;
    }
  }
  return are_any;
}

void FeatureStack::note_place(std::uint32_t row, std::uint32_t trapezoid) {
  const std::uint32_t number = find(row);
  if (number == kNone || !features_[number].is_in_a_pair) return;
  features_[number].box.include(box_around(trapezoid));
}

bool FeatureStack::settle() {
  bool is_any_cut = false;
  by_row_.clear();
  for (std::uint32_t number = 0; number < count_; ++number) {
    by_row_.push_back(number);
    Feature& feature = features_[number];
    if (!options_.cuts_whole_features) {
      std::erase_if(feature.covers, [&](std::uint32_t cover) {
        return !feature.box.intersects(features_[cover].box);
      });
    }
    if (feature.covers.empty()) continue;
    is_any_cut = true;
    for (const std::uint32_t cover : feature.covers) features_[cover].is_over_others = true;
    std::ranges::sort(feature.covers, {}, [this](std::uint32_t cover) {
      return std::pair(features_[cover].box.min_y, features_[cover].row);
    });
  }
  std::ranges::sort(by_row_, {}, [this](std::uint32_t number) { return features_[number].row; });
  return is_any_cut;
}

bool FeatureStack::is_cut(std::uint32_t row) const {
  const std::uint32_t number = find(row);
  return number != kNone && !features_[number].covers.empty();
}

bool FeatureStack::add(std::uint32_t row, std::uint32_t trapezoid) {
  const std::uint32_t number = find(row);
  if (number == kNone) return false;
  Feature& feature = features_[number];
  if (feature.is_over_others) feature.trapezoids.push_back(trapezoid);
  if (feature.covers.empty()) return false;
  if (!options_.cuts_whole_features && !is_covered(feature, trapezoid)) return false;
  feature.below.push_back(trapezoid);
  return true;
}

/// Visits the features over a feature whose boxes intersect a box, until visit(number) is false.
template <typename Visit>
void FeatureStack::for_each_cover(const Feature& feature, const Box& box,
                                  const Visit& visit) const {
  for (const std::uint32_t number : feature.covers) {
    const Box& cover = features_[number].box;
    if (cover.min_y > box.max_y) return;
    if (cover.intersects(box) && !visit(number)) return;
  }
}

bool FeatureStack::is_covered(const Feature& feature, std::uint32_t trapezoid) const {
  bool is_any = false;
  for_each_cover(feature, box_around(trapezoid),
                 [&is_any](std::uint32_t) { return !(is_any = true); });
  return is_any;
}

const Sheet& FeatureStack::sheet_of(Feature& feature) const {
  if (!feature.has_sheet) feature.sheet.assign(mesh_, feature.trapezoids);
  feature.has_sheet = true;
  return feature.sheet;
}

void FeatureStack::cut(Feature& feature, CancellationCheck& check) {
  visible_.begin(mesh_);
  for (const std::uint32_t trapezoid : feature.below) {
    over_.clear();
    for_each_cover(feature, box_around(trapezoid), [this](std::uint32_t cover) {
      over_.push_back(cover);
      return true;
    });
    // In an order that does not depend on what else is visible, because shares are rounded.
    std::ranges::sort(over_, {}, [this](std::uint32_t cover) { return features_[cover].row; });
    visible_.add(trapezoid);
    for (const std::uint32_t cover : over_) {
      visible_.cover(sheet_of(features_[cover]), 1 - features_[cover].paint.opacity, check);
    }
  }
}

}  // namespace trapeze
