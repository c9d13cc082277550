// Finds the attribute of a layer that serves as the title of its features.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/layer/feature_table.h"

namespace trapeze {

/// The index of the field with that name, if one is given, or of a field with a name such as "name"
/// or "title", ignoring case. Nothing if there is none.
std::optional<int> title_field(const FeatureTable& features, std::string_view name = {});

/// The title of a feature, as text; empty if it has none.
std::string title_of(const FeatureTable& features, std::optional<int> field, std::uint32_t row);

}  // namespace trapeze
