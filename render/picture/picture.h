// Pictures in memory: one colour per pixel, for drawing, or runs of equal pixels, as composition
// produces and encoders read them. Row 0 is the northernmost; colours are not premultiplied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/colour.h"
#include "render/picture/origin.h"

namespace trapeze {

/// One colour per pixel.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Rgba> pixels;

  Rgba at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
};

/// Adjacent pixels of a row with the same colour.
struct Run {
  std::uint32_t end = 0;     // the column after the last one
  std::uint32_t colour = 0;  // index
};

/// A picture as runs: the runs of a row are consecutive and fill the width of the picture, so that
/// a picture with few boundaries is small whatever its size.
struct RunPicture {
  int width = 0;
  int height = 0;
  std::vector<Rgba> colours;           // may contain colours without pixels
  std::vector<Origin> origins;         // by colour
  std::vector<Run> runs;               // of all rows
  std::vector<std::uint32_t> row_end;  // by row, the index after its last run

  std::span<const Run> row(int row) const {
    const auto i = static_cast<std::size_t>(row);
    const std::size_t begin = i == 0 ? 0 : row_end[i - 1];
    return std::span(runs).subspan(begin, row_end[i] - begin);
  }
  /// Takes time proportional to the number of runs in the row.
  Rgba at(int column, int row) const;
  bool is_constant() const;
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

Picture to_pixels(const RunPicture& picture);
/// All of its colours get the origin flat.
RunPicture to_runs(const Picture& picture);
/// Sets the runs of the picture to `runs` with other colours: `becomes` has the new index of each.
/// Neighbours that become equal are joined.
void recolour(std::span<const Run> runs, std::span<const std::uint32_t> row_end,
              std::span<const std::uint32_t> becomes, RunPicture& picture);
/// Joins pictures of the same width, from top to bottom. There must be at least one.
RunPicture joined(std::span<const RunPicture* const> pictures);

}  // namespace trapeze
