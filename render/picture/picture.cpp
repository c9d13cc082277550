#include "render/picture/picture.h"

#include <algorithm>

#include "render/picture/colour_numbers.h"

namespace trapeze {

Rgba RunPicture::at(int column, int row) const {
  const auto of_row = this->row(row);
  const auto run = std::ranges::find_if(
      of_row, [column](const Run& r) { return r.end > static_cast<std::uint32_t>(column); });
  return colours[run->colour];
}

bool RunPicture::is_constant() const {
  return std::ranges::all_of(runs,
                             [this](const Run& run) { return run.colour == runs.front().colour; });
}

Picture to_pixels(const RunPicture& picture) {
  Picture made{picture.width, picture.height, {}};
  made.pixels.resize(picture.pixel_count());
  Rgba* row_begin = made.pixels.data();
  for (int row = 0; row < picture.height; ++row, row_begin += picture.width) {
    std::uint32_t begin = 0;
    for (const Run& run : picture.row(row)) {
      std::fill(row_begin + begin, row_begin + run.end, picture.colours[run.colour]);
      begin = run.end;
    }
  }
  return made;
}

RunPicture to_runs(const Picture& picture) {
  RunPicture made{picture.width, picture.height, {}, {}, {}, {}};
  ColourNumbers numbers;
  const Rgba* pixel = picture.pixels.data();
  for (int row = 0; row < picture.height; ++row) {
    for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(picture.width);) {
      const Rgba colour = *pixel;
      const std::uint32_t begin = column;
      while (column < static_cast<std::uint32_t>(picture.width) && *pixel == colour) {
        ++column;
        ++pixel;
      }
      if (column > begin) made.runs.push_back({column, numbers.number_of(colour, Origin::flat)});
    }
    made.row_end.push_back(static_cast<std::uint32_t>(made.runs.size()));
  }
  made.colours = numbers.colours();
  made.origins = numbers.origins();
  return made;
}

void recolour(std::span<const Run> runs, std::span<const std::uint32_t> row_end,
              std::span<const std::uint32_t> becomes, RunPicture& picture) {
  picture.runs.clear();
  picture.runs.reserve(runs.size());
  picture.row_end.clear();
  picture.row_end.reserve(row_end.size());
  std::size_t i = 0;
  for (const std::uint32_t end : row_end) {
    const std::size_t first = picture.runs.size();
    for (; i < end; ++i) {
      const Run run{runs[i].end, becomes[runs[i].colour]};
      if (picture.runs.size() > first && picture.runs.back().colour == run.colour) {
        picture.runs.back().end = run.end;
      } else {
        picture.runs.push_back(run);
      }
    }
    picture.row_end.push_back(static_cast<std::uint32_t>(picture.runs.size()));
  }
}

RunPicture joined(std::span<const RunPicture* const> pictures) {
  RunPicture all;
  all.width = pictures.front()->width;
  std::size_t runs = 0;
  for (const RunPicture* picture : pictures) runs += picture->runs.size();
  all.runs.reserve(runs);
  ColourNumbers numbers;
  std::vector<std::uint32_t> becomes;
  for (const RunPicture* picture : pictures) {
    becomes.clear();
    for (std::size_t i = 0; i < picture->colours.size(); ++i) {
      becomes.push_back(numbers.number_of(picture->colours[i], picture->origins[i]));
    }
    const auto before = static_cast<std::uint32_t>(all.runs.size());
    for (const Run& run : picture->runs) all.runs.push_back({run.end, becomes[run.colour]});
    for (const std::uint32_t end : picture->row_end) all.row_end.push_back(before + end);
    all.height += picture->height;
  }
  all.colours = numbers.colours();
  all.origins = numbers.origins();
  return all;
}

}  // namespace trapeze
