#include "render/compose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>

namespace trapeze {
namespace {

constexpr std::size_t kLevels = 256;

// Premultiplied, 0..1.
struct Paint {
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 0;
};

Paint to_paint(Rgba colour, float coverage) {
  const float a = static_cast<float>(colour.a) / 255.0f * coverage;
  const float scale = a / 255.0f;
  return {static_cast<float>(colour.r) * scale, static_cast<float>(colour.g) * scale,
          static_cast<float>(colour.b) * scale, a};
}

Paint over(const Paint& above, const Paint& below) {
  const float through = 1.0f - above.a;
  return {above.r + below.r * through, above.g + below.g * through, above.b + below.b * through,
          above.a + below.a * through};
}

std::uint8_t to_byte(float share) {
  return static_cast<std::uint8_t>(std::clamp(share, 0.0f, 1.0f) * 255.0f + 0.5f);
}

Rgba to_rgba(const Paint& paint) {
  const std::uint8_t a = to_byte(paint.a);
  if (a == 0) return kTransparent;
  const float scale = 1.0f / paint.a;
  return {to_byte(paint.r * scale), to_byte(paint.g * scale), to_byte(paint.b * scale), a};
}

// The paint of one layer at every level of coverage.
std::array<Paint, kLevels> paints_of(Rgba fill) {
  std::array<Paint, kLevels> paints;
  for (std::size_t level = 0; level < kLevels; ++level) {
    paints[level] = to_paint(fill, static_cast<float>(level) / 255.0f);
  }
  return paints;
}

void require_size(const FilledLayer& layer, int width, int height) {
  if (layer.coverage->width() != width || layer.coverage->height() != height) {
    throw std::invalid_argument("a coverage is not as large as the picture");
  }
}

std::vector<FilledLayer> layers_that_show(std::span<const FilledLayer> layers, int width,
                                          int height) {
  std::vector<FilledLayer> shown;
  for (const FilledLayer& layer : layers) {
    require_size(layer, width, height);
    if (layer.fill.a != 0 && !layer.coverage->is_all(0)) shown.push_back(layer);
  }
  return shown;
}

Picture compose_flat(Rgba background, int width, int height) {
  Picture picture{width, height, {background}, {}, {}};
  picture.indices.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  return picture;
}

// One flat colour over another: the coverages are the indices already.
Picture compose_one(const FilledLayer& layer, Rgba background) {
  const Coverage& coverage = *layer.coverage;
  Picture picture{coverage.width(), coverage.height(), {}, {}, {}};
  picture.indices.assign(coverage.pixels().begin(), coverage.pixels().end());
  const Paint below = to_paint(background, 1);
  picture.palette.reserve(kLevels);
  for (const Paint& paint : paints_of(layer.fill)) {
    picture.palette.push_back(to_rgba(over(paint, below)));
  }
  return picture;
}

std::uint32_t to_bits(Rgba colour) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &colour, sizeof bits);
  return bits;
}

// Turns a picture into an indexed one if its colours are few enough.
void index_colours(Picture& picture) {
  constexpr std::size_t kSlots = 1024;  // open addressing, at most a quarter full
  std::array<std::int16_t, kSlots> slots;
  slots.fill(-1);
  std::vector<Rgba> palette;
  std::vector<std::uint8_t> indices(picture.pixels.size());
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const Rgba colour = picture.pixels[i];
    if (i > 0 && colour == picture.pixels[i - 1]) {
      indices[i] = indices[i - 1];
      continue;
    }
    std::size_t slot = (to_bits(colour) * 2654435761u) >> 22;
    while (slots[slot] >= 0 && palette[static_cast<std::size_t>(slots[slot])] != colour) {
      slot = (slot + 1) % kSlots;
    }
    if (slots[slot] < 0) {
      if (palette.size() == kLevels) return;
      slots[slot] = static_cast<std::int16_t>(palette.size());
      palette.push_back(colour);
    }
    indices[i] = static_cast<std::uint8_t>(slots[slot]);
  }
  picture.palette = std::move(palette);
  picture.indices = std::move(indices);
  picture.pixels.clear();
}

Picture compose_many(std::span<const FilledLayer> layers, Rgba background) {
  const int width = layers.front().coverage->width();
  const int height = layers.front().coverage->height();
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<Paint> canvas(size, to_paint(background, 1));
  for (const FilledLayer& layer : layers) {
    const std::array<Paint, kLevels> paints = paints_of(layer.fill);
    const std::span<const std::uint8_t> levels = layer.coverage->pixels();
    for (std::size_t i = 0; i < size; ++i) {
      if (levels[i] != 0) canvas[i] = over(paints[levels[i]], canvas[i]);
    }
  }
  Picture picture{width, height, {}, {}, {}};
  picture.pixels.resize(size);
  std::transform(canvas.begin(), canvas.end(), picture.pixels.begin(), to_rgba);
  index_colours(picture);
  return picture;
}

}  // namespace

Rgba Picture::at(int column, int row) const {
  const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(column);
  return is_indexed() ? palette[indices[i]] : pixels[i];
}

Picture compose(std::span<const FilledLayer> layers, int width, int height, Rgba background) {
  const std::vector<FilledLayer> shown = layers_that_show(layers, width, height);
  if (shown.empty()) return compose_flat(background, width, height);
  if (shown.size() == 1) return compose_one(shown.front(), background);
  return compose_many(shown, background);
}

}  // namespace trapeze
