#include "server/labels/label_style.h"

#include <spdlog/fmt/fmt.h>

namespace trapeze {

std::string LabelStyle::text_of(const FeatureTable& features, std::uint32_t row,
                                const Fonts& fonts) const {
  const Attributes attributes(features, joined);
  if (!language.empty()) {
    std::string translation = text.translation_of(attributes, translated.get(), row, format);
    if (fonts.can_write(translation)) return translation;
  }
  return text.text_of(attributes, row, format);
}

std::string LabelStyle::placement_key() const {
  return fmt::format(
      "{}:{}|{}|{}|{}|{}|{}|{}|{}|{}|{}|{}|{}|{}{}", written.size(), written,
      format ? number_format_text(*format) : "", joined == nullptr ? "" : joined->key(), language,
      translated == nullptr ? "" : translated->key(), font, size, halo_width, max_width, priority,
      min_size, overhang, repeats ? "" : "once", all_parts ? "all" : "");
}

std::string LabelStyle::key() const {
  return fmt::format("{}|{}|{}", placement_key(), to_hex(colour), to_hex(halo_colour));
}

}  // namespace trapeze
