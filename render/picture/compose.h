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

#include <span>

#include "render/picture/colour.h"
#include "render/picture/mixture_colours.h"
#include "render/picture/mixtures.h"
#include "render/picture/painted_layer.h"
#include "render/picture/picture.h"
#include "render/picture/reduce_colours.h"

namespace trapeze {

/// Paints pictures one after the other, with working memory for reuse.
///
/// Colours are computed once for all runs of pixels that show the same values of the same masks, so
/// the cost grows with the boundaries in a picture and hardly with its pixels.
///
/// Thread-safety: one thread at a time.
class Composer {
 public:
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
  double colour(int along_edges, int of_others);
  void write(RunPicture& picture);

  PictureParts parts_;
  Mixtures mixtures_;
  MixtureFinder finder_;
  MixtureColours mixture_colours_;
  ColourReducer reducer_;
};

}  // namespace trapeze
