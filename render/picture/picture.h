// Pictures in memory: one colour a pixel, to be drawn on, or runs of equal pixels, as composition
// makes them and encoders take them. Row 0 is the northernmost; colours are not premultiplied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/colour.h"
#include "render/picture/origin.h"

namespace trapeze {

/// One colour a pixel.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Rgba> pixels;

  Rgba at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
};

/// Pixels of one colour that lie side by side in a row.
struct Run {
  std::uint32_t end = 0;     // the column after the last of them
  std::uint32_t colour = 0;  // index
};

/// A picture as runs: those of a row follow one another without gaps up to the width of the
/// picture, so that a picture of few boundaries is small whatever its size.
struct RunPicture {
  int width = 0;
  int height = 0;
  std::vector<Rgba> colours;           // may hold colours that no pixel has
  std::vector<Origin> origins;         // by colour
  std::vector<Run> runs;               // of all rows
  std::vector<std::uint32_t> row_end;  // by row, the index after its last run

  std::span<const Run> row(int row) const {
    const auto i = static_cast<std::size_t>(row);
    const std::size_t begin = i == 0 ? 0 : row_end[i - 1];
    return std::span(runs).subspan(begin, row_end[i] - begin);
  }
  /// In a time that grows with the runs of the row.
  Rgba at(int column, int row) const;
  bool is_constant() const;
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

Picture to_pixels(const RunPicture& picture);
/// Every colour of it is flat.
RunPicture to_runs(const Picture& picture);
/// Sets the runs of the picture to those, in other colours: `becomes` has the new number of each.
/// Neighbours that become equal are joined.
void recolour(std::span<const Run> runs, std::span<const std::uint32_t> row_end,
              std::span<const std::uint32_t> becomes, RunPicture& picture);
/// Pictures of one width, one below the other. There is at least one.
RunPicture joined(std::span<const RunPicture* const> pictures);

}  // namespace trapeze
