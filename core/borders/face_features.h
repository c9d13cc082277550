// Which features cover the faces of a coverage.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

/// The features by face: most faces are of one, and others are places that several cover, or
/// that none does and that are told apart all the same (see merging.h).
/// Immutable but for add().
class FaceFeatures {
 public:
  FaceFeatures() = default;
  /// Face i + 1 is of `features[i]`.
  FaceFeatures(std::vector<std::uint32_t> features) : singles_(std::move(features)) {}
  /// Face i + 1 is of feature i.
  static FaceFeatures in_order(std::size_t features) {
    std::vector<std::uint32_t> all(features);
    for (std::size_t i = 0; i < features; ++i) all[i] = static_cast<std::uint32_t>(i);
    return all;
  }

  /// The next face is of several features; its number. They are in ascending order: the later ones
  /// lie over the earlier ones.
  FaceId add(std::vector<std::uint32_t> features) {
    shared_.push_back(std::move(features));
    return static_cast<FaceId>(face_count());
  }

  /// The last faces are so many that no feature covers; no others are added afterwards.
  void add_void(std::size_t faces) { void_ += faces; }

  std::size_t face_count() const { return singles_.size() + shared_.size() + void_; }
  /// Of the faces that are of one feature each, and the first ones.
  std::size_t single_count() const { return singles_.size(); }
  std::span<const std::vector<std::uint32_t>> shared() const { return shared_; }
  /// Of a face, which may be kOutside.
  std::span<const std::uint32_t> of(FaceId face) const {
    if (face == kOutside) return {};
    if (face <= singles_.size()) return {&singles_[face - 1], 1};
    const std::size_t i = face - 1 - singles_.size();
    return i < shared_.size() ? std::span<const std::uint32_t>(shared_[i])
                              : std::span<const std::uint32_t>();
  }
  /// The same with other numbers for features: those of `names`, by feature.
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
