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
  std::string written;  // the template, as it was asked for
  LabelTemplate text;   // of the attributes of the layer and the values joined to them
  std::optional<NumberFormat> format;
  std::shared_ptr<const JoinedValues> joined;  // null: none
  std::string language;                        // empty: none is wanted
  /// The joined values in that language; null: there are none.
  std::shared_ptr<const JoinedValues> translated;
  std::string font;  // of the configuration; empty: the usual ones
  double size = 12;  // side of the em square
  Rgba colour{0x22, 0x22, 0x22, 255};
  Rgba halo_colour{255, 255, 255, 0xcc};
  double halo_width = 1.5;
  double max_width = 120;  // beyond which lines are broken
  /// The attribute, a number, by which those that are greater go first; -1: by area.
  int priority = -1;
  double min_size = 0;     // of the polygon: the side of a square as large as it
  double overhang = 8;     // by how much a label may reach out of its polygon
  bool repeats = true;     // false: equal labels are shown once
  bool all_parts = false;  // false: one label a feature

  /// What the label of the feature in that row says: in the language if the fonts can write that.
  std::string text_of(const FeatureTable& features, std::uint32_t row, const Fonts& fonts) const;

  /// Equal for styles that show the same labels in the same places of one layer.
  std::string placement_key() const;
  /// Equal for those that also look the same.
  std::string key() const;
};

/// A layer of a picture that is labelled, whether it is drawn at its zoom or not.
struct LabelledLayer {
  std::size_t layer = 0;  // position in the dataset
  std::shared_ptr<const LabelStyle> style;
  Classing classing;     // which features are drawn
  double tolerance = 0;  // pixels
  double min_zoom = 0;   // from which on it is drawn
  bool is_drawn = true;  // at the zoom of the picture
};

}  // namespace trapeze
