#include "server/data/title_attribute.h"

#include <algorithm>
#include <array>
#include <variant>

#include "server/base/json_text.h"
#include "server/base/nearest_name.h"

namespace trapeze {
namespace {

// Best first: a name in the local language before one in English.
constexpr std::array<std::string_view, 5> kTitleNames = {"name", "name:en", "name_en", "title",
                                                         "label"};

}  // namespace

std::optional<int> title_field(const FeatureTable& features, std::string_view name) {
  if (!name.empty()) {
    const int field = features.field_index(name);
    return field < 0 ? std::nullopt : std::optional(field);
  }
  for (const std::string_view title : kTitleNames) {
    const auto found = std::ranges::find_if(features.fields(), [title](const Field& field) {
      return in_lower_case(field.name) == title;
    });
    if (found != features.fields().end()) {
      return static_cast<int>(found - features.fields().begin());
    }
  }
  return std::nullopt;
}

std::string title_of(const FeatureTable& features, std::optional<int> field, std::uint32_t row) {
  if (!field) return {};
  const Value value = features.value(row, *field);
  if (const auto* text = std::get_if<std::string_view>(&value)) return std::string(*text);
  const Json number = to_json(value);
  return number.is_null() ? std::string() : number.dump();
}

}  // namespace trapeze
