// The list of all settings of the configuration, each with its key, the values it accepts, its
// meaning, and where its value is stored. Reading, printing and the schema all use these lists.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "server/config/config.h"

namespace trapeze {

using SettingValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

/// An amount is text that a file may also contain as an integer.
enum class SettingType { boolean, integer, number, text, amount, path, list, paths };

template <typename Owner>
struct Setting {
  std::string table;  // "server"; empty for settings of layers
  std::string key;
  SettingType type = SettingType::text;
  std::string help;   // its purpose
  std::string takes;  // valid values, for messages: "an integer from 1 to 256"
  double min = 0;     // of integers and numbers
  double max = 0;
  std::vector<std::string> choices;  // of text: all values; of paths: words that are not paths
  std::function<SettingValue(const Owner&)> get;
  /// False if the value is not valid. The value has the right type, and numbers and choices have
  /// already been checked against the limits.
  std::function<bool(Owner&, const SettingValue&)> set;

  std::string name() const { return table.empty() ? "layer." + key : table + "." + key; }
};

/// All settings of [server], [viewer], [limits], [text], [log] and [admin].
const std::vector<Setting<Config>>& config_settings();
/// All settings of [[layer]] that are single values: everything except the style.
const std::vector<Setting<LayerConfig>>& layer_settings();
/// All settings of [fonts.NAME].
const std::vector<Setting<FontsConfig>>& fonts_settings();
/// All settings of [values.NAME].
const std::vector<Setting<ValueTableConfig>>& value_table_settings();

}  // namespace trapeze
