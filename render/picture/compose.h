// From masks and colours to a picture.
//
// Composition is "source over" in sRGB values, as browsers do it, in floating point, rounded once.
// Classes of one layer are summed by area instead, so that neighbours leave no line between them.
//
// Of layers it is kept apart how much of a pixel they cover, and how opaque they are. Where nothing
// is known of how two layers lie in a pixel, the upper one covers as much of the lower one as it
// covers of the pixel, which is "source over"; where it is known, see Meeting, what lies side by
// side is summed, and what lies beneath is hidden.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/mask/mask.h"
#include "render/picture/colour.h"
#include "render/picture/picture.h"
#include "render/picture/reduce_colours.h"

namespace trapeze {

/// Polygons or lines of one colour. A view of the caller's memory.
struct PaintedClass {
  const Mask* mask = nullptr;  // null: every pixel is wholly covered
  Rgba colour;                 // its opacity included
  // What shines of it through another class of the layer, which counts as covering the pixel.
  bool is_beneath = false;
};

/// How the classes of a layer lie in a pixel in relation to what the layers below it cover there,
/// where both cover a part of it.
struct Meeting {
  static constexpr std::int8_t kSideBySide = -126;  // they share as little area as they can
  static constexpr std::int8_t kNested = 126;       // they share as much area as they can

  std::uint32_t pixel = 0;   // row * width + column
  std::int8_t relation = 0;  // between these two; 0: as much as chance has it
  // How much of what neither of them covers lies between the two, and is covered by none only
  // because their borders were simplified, in 255ths: there the lower one goes on below the upper.
  std::uint8_t gap = 0;

  friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// How much of a pixel two layers that meet in it cover together, each of which covers so much of
/// it, from 0 to 1.
double covered_by(double below, double above, const Meeting& meeting);

/// A layer to be painted: classes of polygons, whose colours mix by the area that each covers; the
/// pattern over them; lines over that, the first one lowest; the opacity applies to the result. A
/// view of the caller's memory.
struct PaintedLayer {
  std::span<const PaintedClass> classes;
  const Mask* pattern = nullptr;  // null: none; counts where the classes cover
  Rgba pattern_colour = kTransparent;
  std::span<const PaintedClass> lines = {};
  double opacity = 1;
  std::span<const Meeting> meetings = {};  // with the layers below, in order of pixels
};

/// Each class as a layer of its own, in this order; views of the classes.
std::vector<PaintedLayer> plain_layers(std::span<const PaintedClass> classes);

/// Paints pictures one after the other, with working memory for reuse.
///
/// Colours are computed once for all runs of pixels that show the same values of the same masks, so
/// the cost grows with the boundaries in a picture and hardly with its pixels.
///
/// Thread-safety: one thread at a time.
class Composer {
 public:
  Composer();
  ~Composer();
  Composer(Composer&&) noexcept;
  Composer& operator=(Composer&&) noexcept;

  /// Paints the layers over the background, the first one lowest (painter's order). The picture
  /// becomes width x height pixels, both at least 1, and every colour of it is of some pixel.
  /// Throws std::invalid_argument if a mask is not of that size.
  ///
  /// Of bounded quality, no channel is further than kMostChange from the exact picture, and all of
  /// them not more than kMostMeanChange in the mean. Colours along edges are then even steps from
  /// one side to the other, and so the same in all tiles that need no finer ones. For others see
  /// ColourReducer.
  void compose(std::span<const PaintedLayer> layers, int width, int height, Rgba background,
               Quality quality, RunPicture& picture);

 private:
  class Painter;

  std::unique_ptr<Painter> painter_;
  ColourReducer reducer_;
  RunPicture other_;  // for its memory
};

}  // namespace trapeze
