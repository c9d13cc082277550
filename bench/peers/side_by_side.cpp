#include "bench/peers/side_by_side.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "render/mask/mask.h"
#include "render/picture/png.h"

namespace trapeze {
namespace {

constexpr int kGap = 4;      // pixels between pictures
constexpr int kFarOff = 64;  // of 255

Rgba on_white(Rgba colour) {
  const auto blend = [&](int channel) {
    return static_cast<std::uint8_t>((channel * colour.a + 255 * (255 - colour.a) + 127) / 255);
  };
  return {blend(colour.r), blend(colour.g), blend(colour.b), 255};
}

int difference(Rgba a, Rgba b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

struct Differences {
  long pixels = 0;
  long far_off = 0;
  double sum = 0;  // of the mean over the channels
};

void add_differences(const Picture& a, const Picture& b, Differences& differences) {
  if (a.width != b.width || a.height != b.height) {
    throw std::runtime_error("a tile is of another size");
  }
  for (int row = 0; row < a.height; ++row) {
    for (int column = 0; column < a.width; ++column) {
      const int sum = difference(on_white(a.at(column, row)), on_white(b.at(column, row)));
      ++differences.pixels;
      differences.sum += sum / 3.0;
      if (sum > 3 * kFarOff) ++differences.far_off;
    }
  }
}

void paste(const Picture& picture, int left, int top, Picture& sheet) {
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const std::size_t place =
          static_cast<std::size_t>(top + row) * static_cast<std::size_t>(sheet.width) +
          static_cast<std::size_t>(left + column);
      sheet.pixels[place] = on_white(picture.at(column, row));
    }
  }
}

}  // namespace

void SideBySide::add(const std::string& name, const std::vector<std::string>& pngs) {
  Column column{name, {}};
  for (const std::string& png : pngs) column.pictures.push_back(decode_png(png));
  columns_.push_back(std::move(column));
}

void SideBySide::print_differences() const {
  for (std::size_t i = 1; i < columns_.size(); ++i) {
    Differences differences;
    for (std::size_t tile = 0; tile < columns_[0].pictures.size(); ++tile) {
      add_differences(columns_[0].pictures[tile], columns_[i].pictures[tile], differences);
    }
    const auto pixels = static_cast<double>(differences.pixels);
    std::printf("%s from %s: mean %.2f of 255, %.3f %% of the pixels off by more than %d\n",
                columns_[i].name.c_str(), columns_[0].name.c_str(), differences.sum / pixels,
                100 * static_cast<double>(differences.far_off) / pixels, kFarOff);
  }
}

void SideBySide::write(const std::string& path) const {
  const auto tiles = static_cast<int>(columns_.at(0).pictures.size());
  Picture sheet;
  sheet.width = static_cast<int>(columns_.size()) * (kTilePixels + kGap);
  sheet.height = tiles * (kTilePixels + kGap);
  sheet.pixels.assign(
      static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height),
      {128, 128, 128, 255});
  for (int tile = 0; tile < tiles; ++tile) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      paste(columns_[i].pictures[static_cast<std::size_t>(tile)],
            static_cast<int>(i) * (kTilePixels + kGap), tile * (kTilePixels + kGap), sheet);
    }
  }
  const std::string png = PngEncoder().encode(to_runs(sheet));
  std::ofstream file(path, std::ios::binary);
  file << png;
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace trapeze
