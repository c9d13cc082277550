// The truth for comparison with tiles: how source polygons look, determined at 16 x 16 points of
// every pixel. Among the features at a point, later ones of the source lie over earlier ones, and
// raised ones over all others; upper layers lie over lower ones. The colour of a pixel is the mean
// of its points, premultiplied.
//
// It shares no code with the program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "tests/oracle/true_layer.h"

namespace trapeze::oracle {

constexpr int kPixels = 256;     // of a side of a tile
constexpr int kPerPixel = 16;    // points, along each side
constexpr double kMaxWidth = 4;  // of an outline, in pixels

struct TileName {
  int zoom = 0;
  std::uint32_t x = 0;
  std::uint32_t y = 0;

  friend bool operator==(const TileName&, const TileName&) = default;
};

/// A square of the map, shown by a picture of kPixels x kPixels pixels.
struct Window {
  Place corner;  // the north-western one
  double side = 1;
};
Window window_of(TileName name);

/// From 0 to 1; not premultiplied.
struct Colour {
  double r = 0;
  double g = 0;
  double b = 0;
  double a = 1;
};

/// How a feature is painted.
struct TrueFill {
  Colour colour;
  bool is_drawn = true;
  bool is_raised = false;  // over all that are not
};

/// How a layer is painted: its fills, and its outlines over them, both with the same opacity.
///
/// A point is inked if an edge is no farther away than half the width of the visible line, and with
/// the strongest ink of these edges. An edge is visible as far as the inside of its feature beside
/// it is: where an opaque feature covers that, the edge is hidden. Rings smaller than four times
/// the width have less ink, in proportion to their extent. Edges along the edges of the world have
/// none.
struct TruePaint {
  std::function<TrueFill(const TrueFeature&)> fill_of;
  double opacity = 1;
  double line_width = 0;  // pixels, at most kMaxWidth
  Colour line = {};
};

/// Red, green, blue, opacity, premultiplied, from 0 to 1.
using PixelSum = std::array<double, 4>;

struct TruePicture {
  std::vector<PixelSum> pixels;  // row by row

  const PixelSum& at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * kPixels + static_cast<std::size_t>(column)];
  }
};

/// Memory for painting, to be reused from tile to tile by one thread.
struct Workspace {
  std::vector<std::uint32_t> top;
  std::vector<std::vector<std::uint8_t>> ink;
  std::vector<std::vector<PixelSum>> sums;
};

/// The part of some layers, the lowest one first, that a tile or another window shows. Keeps
/// references to the layers.
class TrueTile {
 public:
  TrueTile(std::span<const TrueLayer* const> layers, TileName name);
  TrueTile(std::span<const TrueLayer* const> layers, const Window& window);
  ~TrueTile();
  TrueTile(TrueTile&&) noexcept;

  /// Returns a picture for each style; a style has a paint for every layer.
  std::vector<TruePicture> paint(std::span<const std::vector<TruePaint>> styles,
                                 Workspace& workspace) const;

  /// For each pixel, row by row, whether an edge of any feature is within `distance` of its middle.
  std::vector<bool> near_edges(double distance) const;

  /// The source features of a layer whose inside is in the tile or near it.
  std::vector<const TrueFeature*> features(std::size_t layer) const;

 private:
  struct Scene;
  class Painting;
  std::unique_ptr<Scene> scene_;
};

}  // namespace trapeze::oracle
