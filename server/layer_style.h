// How one layer is to be drawn: a request's style, and what the configuration says where it is
// silent, resolved into types.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/colour.h"
#include "server/config.h"
#include "server/dataset.h"
#include "server/feature_classes.h"
#include "server/problem.h"
#include "server/style_parameters.h"

namespace trapeze {

enum class LineJoin : std::uint8_t { bevel, miter, round };

/// Lengths are in pixels of a picture of scale 1.
struct Stroke {
  double width = 0;            // 0: there is none
  std::vector<double> dashes;  // lengths of dashes and gaps in turn, an even number; empty: solid
  LineJoin join = LineJoin::round;

  friend bool operator==(const Stroke&, const Stroke&) = default;
};

enum class PatternKind : std::uint8_t { none, checker, crosshatch, dots, hatch, stripes };

/// Lengths are in pixels of a picture of scale 1.
struct Pattern {
  PatternKind kind = PatternKind::none;
  Rgba colour;
  double size = 8;   // after which it repeats
  double angle = 0;  // degrees, anticlockwise from east, in [0, 360)
  double width = 1;  // of lines, or the diameter of dots

  friend bool operator==(const Pattern&, const Pattern&) = default;
};

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
  /// Equal for styles that draw the same features of one layer in the same way.
  std::string key() const;
};

/// `position` is that of the layer in the dataset. The problem, 400, is a parameter that does not
/// fit the layer, contradicts another, or is locked.
OrProblem<LayerStyle> layer_style(const StyleQuery& query, const ServedLayer& served,
                                  std::size_t position);

/// What fills the layer at `position` of the dataset if a request does not say.
Rgba default_fill(const LayerConfig& config, std::size_t position);

}  // namespace trapeze
