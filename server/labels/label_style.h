// How the features of a layer are labelled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "render/picture/colour.h"
#include "render/text/fonts.h"
#include "server/styles/feature_classes.h"
#include "server/styles/label_template.h"
#include "server/values/joined_values.h"
#include "server/values/number_format.h"

namespace trapeze {

/// Lengths are in pixels of a picture of scale 1.
struct LabelStyle {
  std::string written;  // the template, as requested
  LabelTemplate text;   // with attributes of the layer and joined values
  std::optional<NumberFormat> format;
  std::shared_ptr<const JoinedValues> joined;  // null: none
  std::string language;                        // empty: none requested
  /// The joined values in that language; null: none.
  std::shared_ptr<const JoinedValues> translated;
  std::string font;  // as named in the configuration; empty: the usual fonts
  double size = 12;  // side of the em square
  Rgba colour{0x22, 0x22, 0x22, 255};
  Rgba halo_colour{255, 255, 255, 0xcc};
  double halo_width = 1.5;
  double max_width = 120;  // longer lines are broken
  /// The numeric attribute by which features are ranked, greater values first; -1: by area.
  int priority = -1;
  double min_size = 0;     // minimum size of the polygon: side of a square of its area
  double overhang = 8;     // how far a label may reach out of its polygon
  bool repeats = true;     // false: equal labels are shown once
  bool all_parts = false;  // false: one label per feature

  /// The text of the label for the feature in that row: in the language, if the fonts can write it.
  std::string text_of(const FeatureTable& features, std::uint32_t row, const Fonts& fonts) const;

  /// Equal for styles that show the same labels in the same places of one layer.
  std::string placement_key() const;
  /// Equal for styles whose labels also look the same.
  std::string key() const;
};

/// A labelled layer of a picture, whether or not it is drawn at its zoom.
struct LabelledLayer {
  std::size_t layer = 0;  // position in the dataset
  std::shared_ptr<const LabelStyle> style;
  Classing classing;     // determines which features are drawn
  double tolerance = 0;  // pixels
  double min_zoom = 0;   // from this zoom on it is drawn
  bool is_drawn = true;  // at the zoom of the picture
};

}  // namespace trapeze
