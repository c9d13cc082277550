// Which attribute of a layer is the title of its features: what a reader calls them by.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/layer/feature_table.h"

namespace trapeze {

/// The number of the field: of that name if one is given, else of a name like "name" or "title", in
/// any case of letters. Nothing if there is none.
std::optional<int> title_field(const FeatureTable& features, std::string_view name = {});

/// What it says of a feature, as text; empty if it says nothing.
std::string title_of(const FeatureTable& features, std::optional<int> field, std::uint32_t row);

}  // namespace trapeze
