// The features that cover each face of a coverage.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

/// The features by face. Most faces belong to one feature. Others are places that several features
/// cover, or that none covers but that are distinguished all the same (see merging.h). Immutable
/// except for add().
class FaceFeatures {
 public:
  FaceFeatures() = default;
  /// Face i + 1 belongs to `features[i]`.
  FaceFeatures(std::vector<std::uint32_t> features) : singles_(std::move(features)) {}
  /// Face i + 1 belongs to feature i.
  static FaceFeatures in_order(std::size_t features) {
    std::vector<std::uint32_t> all(features);
    for (std::size_t i = 0; i < features; ++i) all[i] = static_cast<std::uint32_t>(i);
    return all;
  }

  /// Adds a face that belongs to several features and returns its number. The features are in
  /// ascending order: later ones are drawn over earlier ones.
  FaceId add(std::vector<std::uint32_t> features) {
    shared_.push_back(std::move(features));
    return static_cast<FaceId>(face_count());
  }

  /// Adds so many faces that no feature covers, as the last ones: no others may be added
  /// afterwards.
  void add_void(std::size_t faces) { void_ += faces; }

  std::size_t face_count() const { return singles_.size() + shared_.size() + void_; }
  /// The number of faces that belong to one feature each; they are the first ones.
  std::size_t single_count() const { return singles_.size(); }
  std::span<const std::vector<std::uint32_t>> shared() const { return shared_; }
  /// The features of a face, which may be kOutside.
  std::span<const std::uint32_t> of(FaceId face) const {
    if (face == kOutside) return {};
    if (face <= singles_.size()) return {&singles_[face - 1], 1};
    const std::size_t i = face - 1 - singles_.size();
    return i < shared_.size() ? std::span<const std::uint32_t>(shared_[i])
                              : std::span<const std::uint32_t>();
  }
  /// The same with features renumbered: names[i] instead of feature i.
  FaceFeatures named(std::span<const std::uint32_t> names) const {
    FaceFeatures named = *this;
    for (std::uint32_t& feature : named.singles_) feature = names[feature];
    for (auto& features : named.shared_) {
      for (std::uint32_t& feature : features) feature = names[feature];
    }
    return named;
  }

 private:
  std::vector<std::uint32_t> singles_;
  std::vector<std::vector<std::uint32_t>> shared_;
  std::size_t void_ = 0;
};

/// Calls visit(feature) for those of `some` that are not among `others`; both are in ascending
/// order.
template <typename Visit>
void for_each_apart(std::span<const std::uint32_t> some, std::span<const std::uint32_t> others,
                    const Visit& visit) {
  for (const std::uint32_t feature : some) {
    if (!std::ranges::binary_search(others, feature)) visit(feature);
  }
}

}  // namespace trapeze
