// How one layer is drawn: the style of a request, completed from the configuration and resolved
// into types.
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

/// Colours include the opacities.
struct ClassPaint {
  Rgba fill;
  Rgba stroke;

  friend bool operator==(const ClassPaint&, const ClassPaint&) = default;
};

/// How classes were derived, for legends.
struct ClassOrigin {
  std::string attribute;          // by which features are coloured
  std::optional<BreakRule> rule;  // that computed the breaks from its numbers
  /// Of its numbers in the whole layer. Null for a text attribute, or if they were not read.
  std::shared_ptr<const ValueSpread> spread = {};
};

struct LayerStyle {
  std::vector<ClassPaint> paints;  // by class number, one each; at least one
  Stroke stroke;
  Pattern pattern;
  // In pixels of a picture of scale 1. At most one of the two is not 0.
  double grow = 0;     // narrower features are drawn this wide
  double smooth = 0;   // distance from a corner at which its rounding starts
  double opacity = 1;  // of fill, pattern and outline together
  Classing classing;
  std::optional<ClassOrigin> origin = {};  // of classes by value; does not affect the drawing
  std::optional<NumberFormat> label_format = {};
  std::string units = {};
  std::string join_attribute = {};               // attribute by which classing.joined is joined
  std::shared_ptr<const LabelStyle> label = {};  // null: no labels

  /// How features in no class by value are drawn.
  const ClassPaint& paint_of_others() const { return paints[classing.class_of_others()]; }
  /// How far around a picture of that scale features have to be known, in pixels: as far as
  /// outlines reach, for rounded corners as far as the triangles in which they are rounded, and for
  /// growth as far as anything that may be in its way.
  double reach(double scale) const;
  /// Whether it draws any polygon or outline.
  bool is_visible() const;
  /// Equal for styles that draw the same features of one layer in the same way.
  std::string key() const;

  friend bool operator==(const LayerStyle& a, const LayerStyle& b) { return a.key() == b.key(); }
};

/// The style of a request for a layer, completed with the layer's own defaults. The problem is 400
/// if the request sets a locked parameter.
Result<StyleQuery> complete_style(const StyleQuery& query, const LayerConfig& config);

enum class Looking : std::uint8_t {
  for_drawing,  // reads as little as possible
  for_legend,   // fills in ClassOrigin::spread, however the numbers are classed
};

/// `style` is complete; `position` is that of the layer in the dataset. The problem is 400 for a
/// parameter that does not fit the layer or contradicts another one, and 404 for an unknown table
/// of values. Joins and class breaks that were not computed earlier take time in proportion to the
/// number of features.
Result<LayerStyle> layer_style(const StyleQuery& style, const ServedLayer& served,
                               std::size_t position, Looking looking = Looking::for_drawing);

/// Default tolerance, in pixels of the picture: too small to be seen.
constexpr double kTolerancePixels = 0.25;

/// The maximum distance of the layer's drawn boundary from the true one. `style` is complete and
/// fits the layer. If it sets the distance at which features merge to blocks (`merge`), the
/// tolerance at which the layer's blocks bridge that distance.
double tolerance_in_pixels(const StyleQuery& style, const ServedLayer& layer);

/// Whether the style sets anything for that layer for which all of its features must be read: a
/// table to join, or a rule for class breaks. Most styles do not.
bool names_values(const StyleQuery& style, const std::string& layer);

/// Whether layer_style() has to compute more about the layer than fits between two requests.
bool has_to_look(const StyleQuery& style, const ServedLayer& served);

/// The fill of the layer at `position` of the dataset if a request sets none.
Rgba default_fill(const LayerConfig& config, std::size_t position);

}  // namespace trapeze
