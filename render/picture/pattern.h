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

/// A pattern where it lies in one picture. It begins at the north-west corner of the world, so
/// pictures of neighbouring tiles join. Where the world repeats from west to east, the pattern
/// repeats with it: its size and angle are those next to what the style says for which that holds,
/// which is at most 0.71 periods more or fewer in the whole width of the world. Once placed, it may
/// be read by many threads.
class PlacedPattern {
 public:
  /// `scale` is the picture's. Keeps its memory from one picture to the next.
  void place(const Pattern& pattern, const View& view, double scale);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Writes how much of the pixels of a row the pattern covers, from 0 to 255: for column i, from
  /// `begin` to the one before `end`, to values[i].
  void draw(int row, std::size_t begin, std::size_t end, std::uint8_t* values) const;

 private:
  // A place within a period, as a share of it in 2^-32: at the end of a period the next one begins
  // by itself.
  using Phase = std::uint32_t;

  // The shares that bands cover at all places of a period, looked up.
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
  void join_around_the_world(const View& view);

  PatternKind kind_ = PatternKind::none;
  int width_ = 0;
  int height_ = 0;
  double period_ = 1;  // pixels, as the next three
  double band_width_ = 1;
  double west_ = 0;  // of the middle of the first pixel, from the corner of the world
  double north_ = 0;
  // The direction of the pattern, as long as there are periods in a pixel.
  double along_x_ = 1;
  double along_y_ = 0;
  Bands bands_;
};

}  // namespace trapeze
