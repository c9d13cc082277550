#include "tests/oracle/style_cases.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace trapeze::oracle {
namespace {

constexpr std::size_t kMostClasses = 63;  // and one for all others

struct Named {
  const char* hex;
  Colour colour;
};
Colour of_bytes(int r, int g, int b) {
  return {r / 255.0, g / 255.0, b / 255.0, 1};
}
const Named kBlue{"3366cc", of_bytes(0x33, 0x66, 0xcc)};
const Named kSand{"ddbb77", of_bytes(0xdd, 0xbb, 0x77)};
const Named kYellow{"ffcc00", of_bytes(0xff, 0xcc, 0x00)};
const Named kBlack{"000000", of_bytes(0, 0, 0)};
const Named kWhite{"ffffff", of_bytes(0xff, 0xff, 0xff)};
const Named kOther{"808080", of_bytes(0x80, 0x80, 0x80)};
// Assigned in turn to the commonest values.
const std::array<Named, 4> kClassColours = {
    Named{"e41a1c", of_bytes(0xe4, 0x1a, 0x1c)}, Named{"4daf4a", of_bytes(0x4d, 0xaf, 0x4a)},
    Named{"377eb8", of_bytes(0x37, 0x7e, 0xb8)}, Named{"f0e442", of_bytes(0xf0, 0xe4, 0x42)}};

using FillOf = std::function<TrueFill(const TrueFeature&)>;

FillOf all_in(Colour colour) {
  return [colour](const TrueFeature&) { return TrueFill{colour}; };
}

FillOf with_opacity(const FillOf& fill_of, double opacity) {
  return [=](const TrueFeature& feature) {
    TrueFill fill = fill_of(feature);
    fill.colour.a *= opacity;
    return fill;
  };
}

FillOf by_class(const TrueClasses& classes) {
  return [classes](const TrueFeature& feature) {
    const auto value = feature.attribute(classes.attribute);
    const auto& values = classes.values;
    const auto found = value ? std::ranges::find(values, *value) : values.end();
    if (found == values.end()) return TrueFill{kOther.colour};
    const auto number = static_cast<std::size_t>(found - values.begin());
    return TrueFill{kClassColours[number % kClassColours.size()].colour};
  };
}

std::string encoded(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == ' ' ? "%20" : std::string(1, c);
  return out;
}

std::string query_of(const TrueClasses& classes) {
  std::string query = "color-by=" + classes.attribute + "&classes=";
  for (std::size_t i = 0; i < classes.values.size(); ++i) {
    query += encoded(classes.values[i]) + ":" + kClassColours[i % kClassColours.size()].hex + ",";
  }
  return query + "*:" + kOther.hex;
}

bool is_plain_word(const std::string& value) {
  return !value.empty() && std::ranges::all_of(value, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == ' ';
  });
}

}  // namespace

TrueClasses classes_of(const TrueLayer& layer, const std::string& attribute) {
  std::map<std::string, int> counts;
  for (const TrueFeature& feature : layer.features) {
    const auto value = feature.attribute(attribute);
    if (value && is_plain_word(*value)) ++counts[*value];
  }
  std::vector<std::pair<int, std::string>> order;
  for (const auto& [value, count] : counts) order.emplace_back(-count, value);
  std::ranges::sort(order);
  TrueClasses classes{attribute, {}};
  for (const auto& [count, value] : order) {
    if (classes.values.size() < kMostClasses) classes.values.push_back(value);
  }
  return classes;
}

std::vector<StyleCase> styles_of_layer(const TrueClasses& classes,
                                       const std::vector<std::int64_t>& ids) {
  const std::string plain = std::string("fill=") + kBlue.hex;
  const FillOf blue = all_in(kBlue.colour);
  std::vector<StyleCase> styles;
  styles.push_back({"plain", plain, {{blue}}});
  styles.push_back({"half opaque fill", plain + "&fill-opacity=0.5", {{with_opacity(blue, 0.5)}}});
  styles.back().is_opaque = false;
  for (const double width : {1.0, 3.0}) {
    const std::string px = std::to_string(static_cast<int>(width));
    styles.push_back({"outline of " + px + " px",
                      plain + "&stroke=" + kBlack.hex + "&stroke-width=" + px,
                      {{blue, 1, width, kBlack.colour}},
                      width});
  }
  if (!ids.empty()) {
    std::string list;
    for (const std::int64_t id : ids) list += (list.empty() ? "" : ",") + std::to_string(id);
    const std::set<std::int64_t> chosen(ids.begin(), ids.end());
    styles.push_back({"highlight",
                      plain + "&highlight-fill=" + kYellow.hex + "&highlight=" + list,
                      {{[chosen](const TrueFeature& feature) {
                        const bool is_chosen = chosen.contains(feature.id);
                        return TrueFill{is_chosen ? kYellow.colour : kBlue.colour, true, is_chosen};
                      }}}});
  }
  if (classes.values.empty()) return styles;
  const FillOf coloured = by_class(classes);
  const std::string by_value = query_of(classes);
  styles.push_back({"classes", by_value, {{coloured}}});
  styles.push_back(
      {"half opaque classes", by_value + "&fill-opacity=0.5", {{with_opacity(coloured, 0.5)}}});
  styles.back().is_opaque = false;
  styles.push_back({"opacity", by_value + "&opacity=0.5", {{coloured, 0.5}}});
  styles.back().is_opaque = false;
  styles.push_back({"classes and outline",
                    by_value + "&stroke=" + kWhite.hex + "&stroke-width=1",
                    {{coloured, 1, 1, kWhite.colour}},
                    1});
  const std::string without = classes.values[classes.values.size() / 2 > 0 ? 1 : 0];
  styles.push_back({"classes and filter",
                    by_value + "&filter=" + classes.attribute + "<>'" + encoded(without) + "'",
                    {{[=](const TrueFeature& feature) {
                      TrueFill fill = coloured(feature);
                      const auto value = feature.attribute(classes.attribute);
                      fill.is_drawn = value && *value != without;
                      return fill;
                    }}}});
  return styles;
}

std::vector<StyleCase> styles_of_pair(const std::string& lower, const std::string& upper) {
  const std::string plain = lower + ".fill=" + kBlue.hex + "&" + upper + ".fill=" + kSand.hex;
  const TruePaint blue{all_in(kBlue.colour)};
  const TruePaint sand{all_in(kSand.colour)};
  std::vector<StyleCase> styles;
  styles.push_back({"two layers", plain, {blue, sand}});
  styles.push_back({"two layers, the upper one half opaque",
                    plain + "&" + upper + ".opacity=0.5",
                    {blue, {sand.fill_of, 0.5}}});
  styles.back().is_opaque = false;
  return styles;
}

}  // namespace trapeze::oracle
