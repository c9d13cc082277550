// From coverages and colours to a picture.
//
// Composition is "source over" in sRGB values, as browsers do it, in floating point, rounded once.
#pragma once

#include <cstdint>
#include <memory>
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
  const Coverage* coverage = nullptr;  // null: every pixel is wholly covered
  Rgba fill;
};

/// Paints pictures one after the other, in memory that it keeps.
///
/// Thread-safety: one thread at a time.
class Composer {
 public:
  Composer();
  ~Composer();
  Composer(Composer&&) noexcept;
  Composer& operator=(Composer&&) noexcept;

  /// Paints the layers, the first one lowest, over the background. The picture becomes width x
  /// height, both at least 1; so large are all coverages (std::invalid_argument if not). It is
  /// indexed if no more than 256 colours result.
  void compose(std::span<const FilledLayer> layers, int width, int height, Rgba background,
               Picture& picture);

 private:
  class Canvas;
  std::unique_ptr<Canvas> canvas_;
};

}  // namespace trapeze
