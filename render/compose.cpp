#include "render/compose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <vector>

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

std::uint32_t to_bits(Rgba colour) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &colour, sizeof bits);
  return bits;
}

// Eight pixels at once: most of a tile is flat.
constexpr std::size_t kBlock = 8;
constexpr std::uint64_t kEachByte = 0x0101010101010101;

std::uint64_t block_at(const std::uint8_t* levels) {
  std::uint64_t block = 0;
  std::memcpy(&block, levels, sizeof block);
  return block;
}

// From keys to numbers, by open addressing.
class NumberTable {
 public:
  NumberTable() : slots_(512) {}

  // The number of the key; 0, to be set, if it is new.
  std::uint32_t& operator[](std::uint64_t key) {
    if (count_ * 2 >= slots_.size()) grow();
    Slot& slot = find(key);
    if (slot.generation != generation_) {
      slot = {key, 0, generation_};
      ++count_;
    }
    return slot.number;
  }

  // Forgets all keys.
  void clear() {
    count_ = 0;
    if (++generation_ != 0) return;
    std::fill(slots_.begin(), slots_.end(), Slot{});
    generation_ = 1;
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = 0;
    std::uint32_t generation = 0;  // it is empty if this is not the table's
  };

  Slot& find(std::uint64_t key) {
    std::size_t i = (key * 0x9e3779b97f4a7c15) >> 40 & (slots_.size() - 1);
    while (slots_[i].generation == generation_ && slots_[i].key != key) {
      i = (i + 1) & (slots_.size() - 1);
    }
    return slots_[i];
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.generation == generation_) find(slot.key) = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t count_ = 0;
  std::uint32_t generation_ = 1;
};

}  // namespace

// A picture being painted. Pixels that have met the same paints at the same levels share a mixture,
// so that colours are computed once a mixture and not once a pixel; and a block of pixels that are
// all the same is looked at as one.
class Composer::Canvas {
 public:
  void begin(int width, int height, Rgba background) {
    width_ = width;
    height_ = height;
    size_ = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    mixtures_.assign(1, to_paint(background, 1));
    blocks_.assign((size_ + kBlock - 1) / kBlock, 0);
    pixels_.resize(blocks_.size() * kBlock);
  }

  void paint_all(Rgba fill) {
    const Paint paint = to_paint(fill, 1);
    for (Paint& mixture : mixtures_) mixture = over(paint, mixture);
  }

  void paint(const Coverage& coverage, Rgba fill) {
    const std::array<Paint, kLevels> paints = paints_of(fill);
    mixed_.clear();
    const std::uint8_t* levels = coverage.pixels().data();
    const std::size_t whole_blocks = size_ / kBlock;
    for (std::size_t i = 0; i < whole_blocks; ++i, levels += kBlock) paint_block(i, levels, paints);
    if (whole_blocks < blocks_.size()) {
      std::array<std::uint8_t, kBlock> rest{};
      std::copy_n(levels, size_ - whole_blocks * kBlock, rest.begin());
      paint_block(whole_blocks, rest.data(), paints);
    }
    last_key_ = 0;  // what it stands for ends with the layer
  }

  void finish(Picture& picture) {
    picture.width = width_;
    picture.height = height_;
    picture.palette.clear();
    picture.indices.clear();
    picture.pixels.clear();
    if (!to_indices(picture)) to_colours(picture);
  }

 private:
  static constexpr std::uint32_t kMixed = 0xffffffff;  // a block of several mixtures
  static constexpr std::uint16_t kNoIndex = 0xffff;    // a mixture that was not met yet

  void paint_block(std::size_t i, const std::uint8_t* levels,
                   const std::array<Paint, kLevels>& paints) {
    const std::uint64_t block = block_at(levels);
    if (block == 0) return;
    std::uint32_t& mixture = blocks_[i];
    if (mixture != kMixed && block == (block & 0xff) * kEachByte) {
      mixture = mixture_for(mixture, levels[0], paints);
      return;
    }
    std::uint32_t* pixels = pixels_.data() + i * kBlock;
    if (mixture != kMixed) std::fill_n(pixels, kBlock, mixture);
    mixture = kMixed;
    for (std::size_t k = 0; k < kBlock; ++k) {
      if (levels[k] != 0) pixels[k] = mixture_for(pixels[k], levels[k], paints);
    }
  }

  // The mixture that the paint at that level makes of the one below.
  std::uint32_t mixture_for(std::uint32_t below, std::uint8_t level,
                            const std::array<Paint, kLevels>& paints) {
    const std::uint64_t key = std::uint64_t{below} << 8 | level;
    if (key == last_key_) return last_mixture_;
    std::uint32_t& number = mixed_[key];
    if (number == 0) {
      number = static_cast<std::uint32_t>(mixtures_.size());
      const Paint mixture = over(paints[level], mixtures_[below]);
      mixtures_.push_back(mixture);
    }
    last_key_ = key;
    return last_mixture_ = number;
  }

  // False if there are too many colours.
  bool to_indices(Picture& picture) {
    index_of_.assign(mixtures_.size(), kNoIndex);
    indices_by_colour_.clear();
    picture.indices.resize(pixels_.size());
    const bool is_done = translate(picture.indices.data(), [&](std::uint32_t mixture) {
      std::uint16_t& index = index_of_[mixture];
      if (index == kNoIndex) index = index_of(to_rgba(mixtures_[mixture]), picture.palette);
      return index;
    });
    picture.indices.resize(is_done ? size_ : 0);
    if (!is_done) picture.palette.clear();
    return is_done;
  }

  void to_colours(Picture& picture) {
    colours_.resize(mixtures_.size());
    std::transform(mixtures_.begin(), mixtures_.end(), colours_.begin(), to_rgba);
    picture.pixels.resize(pixels_.size());
    translate(picture.pixels.data(), [&](std::uint32_t mixture) { return colours_[mixture]; });
    picture.pixels.resize(size_);
  }

  // kLevels if the palette is full.
  std::uint16_t index_of(Rgba colour, std::vector<Rgba>& palette) {
    std::uint32_t& number = indices_by_colour_[to_bits(colour)];  // counted from 1
    if (number == 0) {
      if (palette.size() == kLevels) return kLevels;
      palette.push_back(colour);
      number = static_cast<std::uint32_t>(palette.size());
    }
    return static_cast<std::uint16_t>(number - 1);
  }

  // Writes what `value_of` says of every pixel's mixture. Ends, false, when that is kLevels.
  template <typename T, typename ValueOf>
  bool translate(T* out, ValueOf value_of) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i, out += kBlock) {
      const std::uint32_t* pixels = pixels_.data() + i * kBlock;
      const std::size_t count = blocks_[i] == kMixed ? kBlock : 1;
      for (std::size_t k = 0; k < count; ++k) {
        const auto value = value_of(count == 1 ? blocks_[i] : pixels[k]);
        if constexpr (std::is_integral_v<T>) {
          if (value == kLevels) return false;
        }
        out[k] = static_cast<T>(value);
      }
      if (count == 1) std::fill_n(out + 1, kBlock - 1, out[0]);
    }
    return true;
  }

  int width_ = 0;
  int height_ = 0;
  std::size_t size_ = 0;               // in pixels
  std::vector<Paint> mixtures_;        // of number 0: the background
  std::vector<std::uint32_t> blocks_;  // the mixture of eight pixels, or kMixed
  std::vector<std::uint32_t> pixels_;  // the mixtures of pixels in mixed blocks
  NumberTable mixed_;                  // by mixture below and level, for the layer of now
  std::uint64_t last_key_ = 0;
  std::uint32_t last_mixture_ = 0;
  std::vector<std::uint16_t> index_of_;  // by mixture
  std::vector<Rgba> colours_;            // by mixture
  NumberTable indices_by_colour_;
};

namespace {

void require_size(const FilledLayer& layer, int width, int height) {
  if (layer.coverage->width() != width || layer.coverage->height() != height) {
    throw std::invalid_argument("a coverage is not as large as the picture");
  }
}

}  // namespace

Rgba Picture::at(int column, int row) const {
  const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(column);
  return is_indexed() ? palette[indices[i]] : pixels[i];
}

Composer::Composer() : canvas_(std::make_unique<Canvas>()) {}
Composer::~Composer() = default;
Composer::Composer(Composer&&) noexcept = default;
Composer& Composer::operator=(Composer&&) noexcept = default;

void Composer::compose(std::span<const FilledLayer> layers, int width, int height, Rgba background,
                       Picture& picture) {
  canvas_->begin(width, height, background);
  for (const FilledLayer& layer : layers) {
    if (layer.coverage != nullptr) require_size(layer, width, height);
    if (layer.fill.a == 0) continue;
    if (layer.coverage == nullptr) {
      canvas_->paint_all(layer.fill);
    } else {
      canvas_->paint(*layer.coverage, layer.fill);
    }
  }
  canvas_->finish(picture);
}

}  // namespace trapeze
