// Composes masks and colours into a picture.
//
// Composition is "source over" in sRGB values, as in browsers, in floating point, rounded once.
// Classes of one layer are summed by area instead, so that no line appears between neighbours.
//
// For layers, the covered area of a pixel and the opacity are treated separately. If nothing is
// known about the relation of two layers in a pixel, the upper one covers the same share of the
// lower one as of the pixel, which is "source over". If it is known, see Meeting, areas side by
// side are summed, and areas beneath are hidden.
#pragma once

#include <span>

#include "render/picture/colour.h"
#include "render/picture/mixture_colours.h"
#include "render/picture/mixtures.h"
#include "render/picture/painted_layer.h"
#include "render/picture/picture.h"
#include "render/picture/reduce_colours.h"

namespace trapeze {

/// Paints pictures one after the other, with reused working memory.
///
/// Colours are computed once for all runs of pixels with the same values of the same masks, so the
/// cost depends on the boundaries in a picture and hardly on its pixels.
///
/// Thread-safety: one thread at a time.
class Composer {
 public:
  /// Paints the layers over the background, the first one lowest (painter's order). The picture is
  /// resized to width x height pixels, both at least 1, and every colour in its table is used by
  /// some pixel. Throws std::invalid_argument if a mask has another size.
  ///
  /// With bounded quality, no channel differs from the exact picture by more than kMostChange, and
  /// the mean over all channels is at most kMostMeanChange. Colours along edges are then in even
  /// steps from one side to the other, and therefore the same in all tiles that need no finer ones.
  /// For other colours see ColourReducer.
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
