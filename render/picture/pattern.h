// Patterns over the fill of polygons, computed from parameters and fixed to the ground.
#pragma once

#include <cstdint>

#include "core/grid/name_table.h"
#include "render/mask/mask.h"
#include "render/picture/colour.h"

namespace trapeze {

enum class PatternKind : std::uint8_t { none, checker, crosshatch, dots, hatch, stripes };

inline constexpr NameTable<PatternKind, 6> kPatternNames({
    {"checker", PatternKind::checker},
    {"crosshatch", PatternKind::crosshatch},
    {"dots", PatternKind::dots},
    {"hatch", PatternKind::hatch},
    {"none", PatternKind::none},
    {"stripes", PatternKind::stripes},
});

/// Lengths are in pixels of a picture of scale 1.
struct Pattern {
  PatternKind kind = PatternKind::none;
  Rgba colour;
  double size = 8;   // period, > 0
  double angle = 0;  // degrees, anticlockwise from east
  double width = 1;  // of lines, or the diameter of dots; > 0

  friend bool operator==(const Pattern&, const Pattern&) = default;
};

/// Replaces the mask, which becomes as large as the view, by how much of every pixel the pattern
/// covers. It begins at the north-west corner of the world, so pictures of neighbouring tiles join.
/// `scale` is the picture's. Nothing is covered by a pattern of kind none.
void draw_pattern(const Pattern& pattern, const View& view, int scale, Mask& mask);

}  // namespace trapeze
