// How one layer is to be drawn: a request's style, and what the configuration says where it is
// silent, resolved into types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/mask/stroke.h"
#include "render/picture/colour.h"
#include "render/picture/pattern.h"
#include "server/base/result.h"
#include "server/config/config.h"
#include "server/data/dataset.h"
#include "server/labels/label_style.h"
#include "server/styles/feature_classes.h"
#include "server/styles/style_parameters.h"
#include "server/values/class_breaks.h"
#include "server/values/joined_values.h"
#include "server/values/value_spread.h"

namespace trapeze {

/// Opacities are part of the colours.
struct ClassPaint {
  Rgba fill;
  Rgba stroke;

  friend bool operator==(const ClassPaint&, const ClassPaint&) = default;
};

/// Where classes come from, for legends.
struct ClassOrigin {
  std::string attribute;          // by which features are coloured
  std::optional<BreakRule> rule;  // by which its numbers were parted
  /// Of its numbers, in all of the layer; null where it holds texts, or they were not looked at.
  std::shared_ptr<const ValueSpread> spread = {};
};

struct LayerStyle {
  std::vector<ClassPaint> paints;  // by number of class, one for each; at least one
  Stroke stroke;
  Pattern pattern;
  // In pixels of a picture of scale 1. At most one of them is not 0.
  double grow = 0;     // how wide what is narrower is drawn
  double smooth = 0;   // how far from corners they are rounded
  double opacity = 1;  // of fill, pattern and outline together
  Classing classing;
  std::optional<ClassOrigin> origin = {};  // of classes by value; nothing of what it says is drawn
  std::optional<NumberFormat> label_format = {};
  std::string units = {};
  std::string join_attribute = {};               // by which classing.joined is joined
  std::shared_ptr<const LabelStyle> label = {};  // null: no labels

  /// How features are drawn that are in no class by value.
  const ClassPaint& paint_of_others() const { return paints[classing.class_of_others()]; }
  /// How far beyond a picture of that scale it has to be known what there is, in pixels: as far as
  /// outlines reach, for corners what may lie within the triangles in which they are rounded, and
  /// for what grows, whatever may be in its way.
  double reach(double scale) const;
  /// Whether any polygon or outline is drawn with it.
  bool is_visible() const;
  /// Equal for styles that draw the same features of one layer in the same way.
  std::string key() const;

  friend bool operator==(const LayerStyle& a, const LayerStyle& b) { return a.key() == b.key(); }
};

/// What a request says about a layer, with the layer's own defaults where it is silent. The
/// problem, 400, is a parameter that is locked.
Result<StyleQuery> complete_style(const StyleQuery& query, const LayerConfig& config);

enum class Looking : std::uint8_t {
  for_drawing,  // at as little as it takes
  for_legend,   // ClassOrigin::spread is there whatever parts the numbers
};

/// `style` is complete, and `position` that of the layer in the dataset. The problem is 400 for a
/// parameter that does not fit the layer, or contradicts another, and 404 for a table of values
/// that there is not. Joins and classes that were not found out before take time of the features.
Result<LayerStyle> layer_style(const StyleQuery& style, const ServedLayer& served,
                               std::size_t position, Looking looking = Looking::for_drawing);

/// Usual tolerance, in pixels of the picture: too small to be seen.
constexpr double kTolerancePixels = 0.25;

/// How far the drawn boundary of the layer may be from the true one. `style` is
/// complete and fits the layer. Where it asks for blocks
/// of what is so and so far apart, that tolerance at which they are.
double tolerance_in_pixels(const StyleQuery& style, const ServedLayer& layer);

/// Whether the style says something of that layer for which all of its features have to be known: a
/// table to join, or a rule for breaks. Most say nothing like that.
bool names_values(const StyleQuery& style, const std::string& layer);

/// Whether layer_style() has to find out more about the layer than fits between two requests.
bool has_to_look(const StyleQuery& style, const ServedLayer& served);

/// What fills the layer at `position` of the dataset if a request does not say.
Rgba default_fill(const LayerConfig& config, std::size_t position);

}  // namespace trapeze
