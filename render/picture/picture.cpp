#include "render/picture/picture.h"

#include <algorithm>

#include "render/picture/number_table.h"

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
  NumberTable<ColourKey> numbers;
  const Rgba* pixel = picture.pixels.data();
  for (int row = 0; row < picture.height; ++row) {
    for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(picture.width);) {
      const Rgba colour = *pixel;
      const std::uint32_t begin = column;
      while (column < static_cast<std::uint32_t>(picture.width) && *pixel == colour) {
        ++column;
        ++pixel;
      }
      std::uint32_t& number = numbers[ColourKey(colour)];
      if (number == NumberTable<ColourKey>::kNone) {
        number = static_cast<std::uint32_t>(made.colours.size());
        made.colours.push_back(colour);
      }
      if (column > begin) made.runs.push_back({column, number});
    }
    made.row_end.push_back(static_cast<std::uint32_t>(made.runs.size()));
  }
  made.origins.resize(made.colours.size());
  return made;
}

RunPicture joined(std::span<const RunPicture* const> pictures) {
  RunPicture all;
  all.width = pictures.front()->width;
  NumberTable<ColourKey> numbers;
  for (const RunPicture* picture : pictures) {
    std::vector<std::uint32_t> becomes;
    for (std::size_t i = 0; i < picture->colours.size(); ++i) {
      std::uint32_t& number = numbers[ColourKey(picture->colours[i])];
      if (number == NumberTable<ColourKey>::kNone) {
        number = static_cast<std::uint32_t>(all.colours.size());
        all.colours.push_back(picture->colours[i]);
        all.origins.push_back(picture->origins[i]);
      }
      all.origins[number] = std::min(all.origins[number], picture->origins[i]);
      becomes.push_back(number);
    }
    const auto before = static_cast<std::uint32_t>(all.runs.size());
    for (const Run& run : picture->runs) all.runs.push_back({run.end, becomes[run.colour]});
    for (const std::uint32_t end : picture->row_end) all.row_end.push_back(before + end);
    all.height += picture->height;
  }
  return all;
}

}  // namespace trapeze
