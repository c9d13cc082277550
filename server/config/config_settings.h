// Every setting of the configuration, once: its key, what it takes, what it means, and where its
// value is. Reading, printing and the schema all go by these lists.
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

/// An amount is text that a file may also give as a whole number.
enum class SettingType { boolean, integer, number, text, amount, path, list, paths };

template <typename Owner>
struct Setting {
  std::string table;  // "server"; empty for those of layers
  std::string key;
  SettingType type = SettingType::text;
  std::string help;   // what it is for
  std::string takes;  // what it takes, for messages: "an integer from 1 to 256"
  double min = 0;     // of integers and numbers
  double max = 0;
  std::vector<std::string> choices;  // of text: all there are; of paths: words that are none
  std::function<SettingValue(const Owner&)> get;
  /// False if the value is not one that it takes; the value has the right type, and numbers and
  /// choices are within what is allowed.
  std::function<bool(Owner&, const SettingValue&)> set;

  std::string name() const { return table.empty() ? "layer." + key : table + "." + key; }
};

/// All of [server], [viewer], [limits], [text], [log] and [admin].
const std::vector<Setting<Config>>& config_settings();
/// All of [[layer]] that is one value: all but its style.
const std::vector<Setting<LayerConfig>>& layer_settings();
/// All of [fonts.NAME].
const std::vector<Setting<FontsConfig>>& fonts_settings();
/// All of [values.NAME].
const std::vector<Setting<ValueTableConfig>>& value_table_settings();

}  // namespace trapeze
