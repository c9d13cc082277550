// The attributes of features as filters and classes see them: the attributes of a layer and, under
// the name "value", the values joined to them.
//
// Thread-safety: immutable, any number of threads may read.
#pragma once

#include <cmath>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

#include "core/layer/feature_table.h"
#include "server/values/joined_values.h"

namespace trapeze {

/// The name of joined values. It hides an attribute with the same name.
constexpr std::string_view kJoinedName = "value";

/// Refers to the features, which must outlive it.
class Attributes {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): features without joined values are such
  Attributes(const FeatureTable& features, std::shared_ptr<const JoinedValues> joined = nullptr)
      : features_(&features), joined_(std::move(joined)) {
    if (joined_ != nullptr) joined_field_ = {std::string(kJoinedName), joined_->table().type()};
  }

  const FeatureTable& features() const { return *features_; }
  const JoinedValues* joined() const { return joined_.get(); }
  /// The index of joined values, as if they were an attribute.
  int joined_index() const { return static_cast<int>(features_->fields().size()); }

  /// The index of the attribute with that name, or -1.
  int field_index(std::string_view name) const {
    if (joined_ != nullptr && name == kJoinedName) return joined_index();
    return features_->field_index(name);
  }
  const Field& field(int index) const {
    return index == joined_index() ? joined_field_
                                   : features_->fields()[static_cast<std::size_t>(index)];
  }
  /// Null also for a number that is not finite, as in the documents: JSON has none.
  Value value(std::uint32_t row, int index) const {
    const Value value =
        index == joined_index() ? joined_->value(row) : features_->value(row, index);
    const auto* real = std::get_if<double>(&value);
    return real != nullptr && !std::isfinite(*real) ? Value() : value;
  }

 private:
  const FeatureTable* features_;
  std::shared_ptr<const JoinedValues> joined_;  // null: none
  Field joined_field_;
};

}  // namespace trapeze
