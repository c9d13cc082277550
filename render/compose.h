// From coverages and colours to a picture.
//
// Composition is "source over" in sRGB values, as browsers do it, in floating point, rounded once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/colour.h"
#include "render/coverage.h"

namespace trapeze {

/// A picture in one of two forms: a palette with one index a pixel, or, where the palette is empty,
/// one colour a pixel. Row 0 is the northernmost; colours are not premultiplied.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Rgba> palette;          // at most 256; may hold colours that no pixel has
  std::vector<std::uint8_t> indices;  // into the palette
  std::vector<Rgba> pixels;

  bool is_indexed() const { return !palette.empty(); }
  Rgba at(int column, int row) const;
};

/// A class of polygons with the colour that fills them, its opacity included. Looks at memory of
/// the caller.
struct FilledLayer {
  const Coverage* coverage = nullptr;
  Rgba fill;
};

/// Paints the layers, the first one lowest, over the background. All coverages are width x height.
/// The picture is indexed if at most one layer shows at all, or if no more than 256 colours result.
Picture compose(std::span<const FilledLayer> layers, int width, int height,
                Rgba background = kTransparent);

}  // namespace trapeze
