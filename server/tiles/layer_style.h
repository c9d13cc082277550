// How one layer is to be drawn: a request's style, and what the configuration says where it is
// silent, resolved into types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/mask/stroke.h"
#include "render/picture/colour.h"
#include "render/picture/pattern.h"
#include "server/base/result.h"
#include "server/config/config.h"
#include "server/data/dataset.h"
#include "server/styles/feature_classes.h"
#include "server/styles/style_parameters.h"

namespace trapeze {

/// Opacities are part of the colours.
struct ClassPaint {
  Rgba fill;
  Rgba stroke;

  friend bool operator==(const ClassPaint&, const ClassPaint&) = default;
};

struct LayerStyle {
  std::vector<ClassPaint> paints;  // by number of class, one for each; at least one
  Stroke stroke;
  Pattern pattern;
  double opacity = 1;  // of fill, pattern and outline together
  Classing classing;

  /// How features are drawn that are in no class by value.
  const ClassPaint& paint_of_others() const { return paints[classing.class_of_others()]; }
  /// Whether anything is drawn with it.
  bool is_visible() const;
  /// Equal for styles that draw the same features of one layer in the same way.
  std::string key() const;

  friend bool operator==(const LayerStyle& a, const LayerStyle& b) { return a.key() == b.key(); }
};

/// What a request says about a layer, with the layer's own defaults where it is silent. The
/// problem, 400, is a parameter that is locked.
Result<StyleQuery> complete_style(const StyleQuery& query, const LayerConfig& config);

/// `style` is complete, and `position` that of the layer in the dataset. The problem, 400, is a
/// parameter that does not fit the layer, or contradicts another.
Result<LayerStyle> layer_style(const StyleQuery& style, const ServedLayer& served,
                               std::size_t position);

/// What fills the layer at `position` of the dataset if a request does not say.
Rgba default_fill(const LayerConfig& config, std::size_t position);

}  // namespace trapeze
