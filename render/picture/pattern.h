// Patterns over the fill of polygons, computed from parameters and fixed to the ground.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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

/// A pattern at its position in one picture. It starts at the north-west corner of the world, so
/// pictures of neighbouring tiles join. Where the world repeats from west to east, the pattern
/// repeats with it: size and angle are rounded to the nearest values that allow this, which changes
/// the number of periods across the world by at most 0.71. Once placed, it may be read by many
/// threads.
class PlacedPattern {
 public:
  /// `scale` is that of the picture. Reuses its memory from one picture to the next.
  void place(const Pattern& pattern, const View& view, double scale);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Writes the coverage of the pixels of a row by the pattern, from 0 to 255: for column i, from
  /// `begin` to `end` - 1, to values[i].
  void draw(int row, std::size_t begin, std::size_t end, std::uint8_t* values) const;

 private:
  // A position within a period, as a multiple of 2^-32 of the period: it wraps around at the end of
  // a period by itself.
  using Phase = std::uint32_t;

  // A table of the coverage by bands at all positions of a period.
  class Bands {
   public:
    void assign(double period, double width);
    float at(Phase phase) const { return values_[phase >> shift_]; }

   private:
    int shift_ = 0;
    std::vector<float> values_;
  };
  // The phases of a pixel along the direction of the pattern and across it.
  struct Phases {
    Phase along;
    Phase across;
  };

  template <typename ShareAt>
  void draw_by(int row, std::size_t begin, std::size_t end, std::uint8_t* values,
               const ShareAt& share_at) const;
  void draw_dots(int row, std::size_t begin, std::size_t end, std::uint8_t* values) const;
  Phases phases_at(double x, double y) const;
  void join_around_the_world(const View& view, double scale);

  PatternKind kind_ = PatternKind::none;
  int width_ = 0;
  int height_ = 0;
  double period_ = 1;  // pixels, like the next three
  double band_width_ = 1;
  double west_ = 0;  // of the centre of the first pixel, from the corner of the world
  double north_ = 0;
  double row_height_ = 1;  // as a multiple of the nominal one
  // The direction of the pattern, as long as there are periods in a pixel.
  double along_x_ = 1;
  double along_y_ = 0;
  Bands bands_;
};

}  // namespace trapeze
