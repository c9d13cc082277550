#include "server/labels/draw_labels.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "render/picture/blend.h"

namespace trapeze {
namespace {

/// The colour numbers of a picture, extended by those of its labels.
class ColourBook {
 public:
  explicit ColourBook(RunPicture& picture) : picture_(picture) {
    for (std::size_t i = 0; i < picture.colours.size(); ++i) {
      numbers_.emplace(bits_of(picture.colours[i]), static_cast<std::uint32_t>(i));
    }
  }

  std::uint32_t number_of(Rgba colour) {
    const auto next = static_cast<std::uint32_t>(picture_.colours.size());
    const auto [found, is_new] = numbers_.emplace(bits_of(colour), next);
    if (is_new) {
      picture_.colours.push_back(colour);
      picture_.origins.push_back(Origin::mixed);
    }
    return found->second;
  }

 private:
  static std::uint32_t bits_of(Rgba colour) {
    return static_cast<std::uint32_t>(colour.r) << 24 | static_cast<std::uint32_t>(colour.g) << 16 |
           static_cast<std::uint32_t>(colour.b) << 8 | colour.a;
  }

  RunPicture& picture_;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;
};

/// Draws the row of a label over a row of a picture.
void draw_row(const DrawnLabel& label, int row, Picture& pixels) {
  const TextMask& mask = label.image->mask();
  const LabelImage::Look& look = label.image->look();
  const std::size_t begin =
      static_cast<std::size_t>(row - label.top) * static_cast<std::size_t>(mask.width);
  const int first = std::max(label.left, 0);
  const int end = std::min(label.left + mask.width, pixels.width);
  for (int column = first; column < end; ++column) {
    const std::size_t i = begin + static_cast<std::size_t>(column - label.left);
    if (mask.halo[i] == 0) continue;
    blend(pixels, column, 0, look.halo, mask.halo[i] / 255.0);
    if (mask.letters[i] == 0) continue;
    blend(pixels, column, 0, look.letters, mask.letters[i] / 255.0);
  }
}

}  // namespace

void draw_labels(std::span<const DrawnLabel> labels, RunPicture& picture) {
  const auto height = static_cast<std::size_t>(picture.height);
  std::vector<std::vector<std::uint32_t>> by_row(height);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const int end = std::min(labels[i].top + labels[i].image->look().height, picture.height);
    for (int row = std::max(labels[i].top, 0); row < end; ++row) {
      by_row[static_cast<std::size_t>(row)].push_back(static_cast<std::uint32_t>(i));
    }
  }
  ColourBook colours(picture);
  std::vector<Run> runs;
  runs.reserve(picture.runs.size() * 2);
  std::vector<std::uint32_t> row_end(height);
  Picture pixels{picture.width, 1, std::vector<Rgba>(static_cast<std::size_t>(picture.width))};
  for (std::size_t row = 0; row < height; ++row) {
    const auto given = picture.row(static_cast<int>(row));
    if (by_row[row].empty()) {
      runs.insert(runs.end(), given.begin(), given.end());
      row_end[row] = static_cast<std::uint32_t>(runs.size());
      continue;
    }
    std::size_t column = 0;
    for (const Run& run : given) {
      std::fill(pixels.pixels.begin() + static_cast<std::ptrdiff_t>(column),
                pixels.pixels.begin() + run.end, picture.colours[run.colour]);
      column = run.end;
    }
    for (const std::uint32_t i : by_row[row]) draw_row(labels[i], static_cast<int>(row), pixels);
    for (std::size_t i = 0; i < pixels.pixels.size();) {
      const Rgba colour = pixels.pixels[i];
      std::size_t end = i + 1;
      while (end < pixels.pixels.size() && pixels.pixels[end] == colour) ++end;
      runs.push_back({static_cast<std::uint32_t>(end), colours.number_of(colour)});
      i = end;
    }
    row_end[row] = static_cast<std::uint32_t>(runs.size());
  }
  picture.runs = std::move(runs);
  picture.row_end = std::move(row_end);
}

}  // namespace trapeze
