#include "render/picture/compose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

namespace trapeze {
namespace {

constexpr std::size_t kValues = 256;

// What one or several layers show of a pixel. Colours are premultiplied; all from 0 to 1.
struct Paint {
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 0;
  float covered = 0;  // how much of the pixel they cover, however transparent they are
  float beneath = 0;  // how much of it shows what lies beneath them through what they cover
  float classes = 0;  // within a layer only: how many there are
};

// Of something that covers that share of the pixel.
Paint to_paint(Rgba colour, float share, float opacity = 1) {
  const float a = static_cast<float>(colour.a) / 255.0f * share * opacity;
  const float scale = a / 255.0f;
  return {static_cast<float>(colour.r) * scale, static_cast<float>(colour.g) * scale,
          static_cast<float>(colour.b) * scale, a, share};
}

// The colours of one times a factor, and those of the other times a factor; the rest is that of the
// other.
Paint mixed(const Paint& one, float of_one, const Paint& other, float of_other) {
  Paint sum = other;
  sum.r = one.r * of_one + other.r * of_other;
  sum.g = one.g * of_one + other.g * of_other;
  sum.b = one.b * of_one + other.b * of_other;
  sum.a = one.a * of_one + other.a * of_other;
  return sum;
}

Paint faded(const Paint& paint, float opacity) {
  Paint fainter = mixed(paint, opacity, {}, 0);
  fainter.covered = paint.covered;
  return fainter;
}

// Lays a paint over another one that covers the same places as often as chance has it.
Paint over(const Paint& above, const Paint& below) {
  Paint sum = mixed(above, 1, below, 1.0f - above.a);
  sum.covered = above.covered + below.covered * (1.0f - above.covered);
  sum.beneath =
      below.beneath * (1.0f - above.a) + (1.0f - below.covered) * (above.covered - above.a);
  return sum;
}

// How two layers that meet in a pixel share it.
template <typename Number>
struct Shares {
  Number covered = 0;  // by the lower one, and what it goes on below the upper one
  Number common = 0;   // by both
};

template <typename Number>
Shares<Number> shares_of(Number below, Number above, const Meeting& meeting) {
  const auto common_of = [&](Number covered) {
    const Number chance = covered * above;
    const Number relation = static_cast<Number>(meeting.relation) / Meeting::kNested;
    if (relation < 0) {
      const Number least = std::max(Number{0}, above + covered - 1);
      return chance + relation * (chance - least);
    }
    return chance + relation * (std::min(above, covered) - chance);
  };
  const Number neither = std::max(Number{0}, 1 - above - below + common_of(below));
  const Number covered = below + neither * static_cast<Number>(meeting.gap) / 255;
  return {covered, common_of(covered)};
}

// Lays a paint over another one, of which it is known how they lie in the pixel.
Paint over(const Paint& above, const Paint& below, const Meeting& meeting) {
  if (above.covered == 0 || below.covered == 0) return over(above, below);
  const auto [covered, common] = shares_of(below.covered, above.covered, meeting);
  const float opacity = above.a / above.covered;
  const float left = (1.0f - opacity * common / covered) * covered / below.covered;
  Paint sum = mixed(above, 1, below, left);
  sum.covered = above.covered + covered - common;
  sum.beneath = below.beneath * left + (above.covered - common) * (1.0f - opacity);
  return sum;
}

// Adds what shines of a class through others.
Paint added(const Paint& one, const Paint& other) {
  return mixed(one, 1, other, 1);
}

// Adds a class that lies beside others.
Paint beside(const Paint& one, const Paint& other) {
  Paint sum = added(one, other);
  sum.covered += one.covered;
  sum.classes += 1;
  return sum;
}

// A pattern's paint, wherever the classes below it are.
Paint within(const Paint& above, const Paint& below) {
  return mixed(above, below.covered, below, 1.0f - above.a);
}

// Where classes overlap, each has its share. And where they join, each value was rounded; the pixel
// is wholly covered all the same.
Paint settled(const Paint& sum) {
  constexpr float kHalfValue = 0.501f / 255;  // and what the sum lost in rounding
  const bool is_whole = sum.classes > 1 && sum.covered > 1 - kHalfValue * sum.classes;
  if (!is_whole && sum.covered <= 1) return sum;
  Paint paint = mixed(sum, 1 / sum.covered, {}, 0);
  paint.covered = 1;
  return paint;
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

// The paint of one class at every value of its mask.
std::array<Paint, kValues> paints_of(Rgba colour, float opacity = 1) {
  std::array<Paint, kValues> paints;
  for (std::size_t value = 0; value < kValues; ++value) {
    paints[value] = to_paint(colour, static_cast<float>(value) / 255.0f, opacity);
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

std::uint64_t block_at(const std::uint8_t* values) {
  std::uint64_t block = 0;
  std::memcpy(&block, values, sizeof block);
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

// A picture being painted. Pixels that have met the same paints at the same values share a mixture,
// so that colours are computed once a mixture and not once a pixel; and a block of equal
// pixels is treated as one.
class Composer::Canvas {
 public:
  void begin(int width, int height, Rgba background) {
    width_ = width;
    height_ = height;
    size_ = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    background_ = to_paint(background, 1);
    mixtures_.assign(1, Paint());
    blocks_.assign((size_ + kBlock - 1) / kBlock, 0);
    pixels_.resize(blocks_.size() * kBlock);
  }

  /// Changes every pixel, by mix(mixture, value). Nothing is changed where the value is 0.
  template <typename Mix>
  void paint(const Mask* mask, const Mix& mix) {
    if (mask == nullptr) {
      for (Paint& mixture : mixtures_) mixture = mix(mixture, std::uint8_t{255});
      return;
    }
    mixed_.clear();
    rows_.clear();
    row_of_.assign(mixtures_.size(), kNoRow);
    const std::uint8_t* values = mask->pixels().data();
    const std::size_t whole_blocks = size_ / kBlock;
    for (std::size_t i = 0; i < whole_blocks; ++i, values += kBlock) paint_block(i, values, mix);
    if (whole_blocks < blocks_.size()) {
      std::array<std::uint8_t, kBlock> rest{};
      std::copy_n(values, size_ - whole_blocks * kBlock, rest.begin());
      paint_block(whole_blocks, rest.data(), mix);
    }
    last_key_ = 0;  // what it stands for ends with the layer
  }

  /// Changes every pixel, by mix(mixture, value, value of the pattern). Nothing is changed where
  /// the value is 0.
  template <typename Mix>
  void paint(const Mask* mask, const Mask& pattern, const Mix& mix) {
    mixed_.clear();
    last_key_ = 0;
    const std::uint8_t* patterns = pattern.pixels().data();
    const std::uint8_t* values = mask == nullptr ? nullptr : mask->pixels().data();
    for (std::size_t i = 0; i < size_; i += kBlock) {
      const std::size_t count = std::min(kBlock, size_ - i);
      const bool is_empty = values != nullptr && count == kBlock && block_at(values + i) == 0;
      if (is_empty) continue;
      std::uint32_t& block = blocks_[i / kBlock];
      if (block != kMixed) std::fill_n(pixels_.data() + i, kBlock, block);
      block = kMixed;
      for (std::size_t k = i; k < i + count; ++k) {
        const std::uint8_t value = values == nullptr ? 255 : values[k];
        if (value == 0) continue;
        const std::uint32_t below = pixels_[k];
        pixels_[k] = number_of(std::uint64_t{below} << 16 | std::uint64_t{value} << 8 | patterns[k],
                               [&] { return mix(mixtures_[below], value, patterns[k]); });
      }
    }
    last_key_ = 0;
  }

  /// Changes the mixtures themselves, by change(mixture).
  template <typename Change>
  void change_all(const Change& change) {
    for (Paint& mixture : mixtures_) mixture = change(mixture);
  }

  /// Whether nothing has been painted yet.
  bool is_blank() const {
    return mixtures_.size() == 1 && mixtures_[0].a == 0 && mixtures_[0].covered == 0;
  }

  /// Becomes what paint_over() of this canvas would make of another one, which is blank.
  void lie_over_blank(const Canvas& blank, float opacity) {
    background_ = blank.background_;
    change_all([opacity](const Paint& paint) { return over(faded(paint, opacity), {}); });
  }

  /// Paints another canvas of the same size over this one, with that opacity.
  void paint_over(const Canvas& other, float opacity) {
    mixed_.clear();
    last_key_ = 0;
    const auto mix_pixel = [&](std::uint32_t below, std::uint32_t above) {
      // Counted from 1, so that no key is that of nothing.
      return number_of(std::uint64_t{below} << 32 | (above + 1), [&] {
        return over(faded(other.mixtures_[above], opacity), mixtures_[below]);
      });
    };
    const bool begins_empty = other.mixtures_[0].a == 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const std::uint32_t above = other.blocks_[i];
      if (above == 0 && begins_empty) continue;
      if (above != kMixed && blocks_[i] != kMixed) {
        blocks_[i] = mix_pixel(blocks_[i], above);
        continue;
      }
      std::uint32_t* pixels = pixels_.data() + i * kBlock;
      const std::uint32_t* others = other.pixels_.data() + i * kBlock;
      if (blocks_[i] != kMixed) std::fill_n(pixels, kBlock, blocks_[i]);
      blocks_[i] = kMixed;
      for (std::size_t k = 0; k < kBlock; ++k) {
        pixels[k] = mix_pixel(pixels[k], above == kMixed ? others[k] : above);
      }
    }
    last_key_ = 0;
  }

  /// Notes what is there now in the pixels of meetings, for meet().
  void note_below(std::span<const Meeting> meetings) {
    below_.clear();
    for (const Meeting& meeting : meetings) {
      std::uint32_t& block = blocks_[meeting.pixel / kBlock];
      std::uint32_t* const pixels = pixels_.data() + meeting.pixel / kBlock * kBlock;
      if (block != kMixed) std::fill_n(pixels, kBlock, block);
      block = kMixed;
      below_.push_back(pixels[meeting.pixel % kBlock]);
    }
  }

  /// Paints the pixels of these meetings anew, by mix(what was there, meeting); what
  /// `number_above(meeting)` tells apart is less than 2^24.
  template <typename NumberAbove, typename Mix>
  void meet(std::span<const Meeting> meetings, const NumberAbove& number_above, const Mix& mix) {
    if (meetings.empty()) return;
    mixed_.clear();
    last_key_ = 0;
    for (std::size_t i = 0; i < meetings.size(); ++i) {
      const Meeting& meeting = meetings[i];
      // Counted from 1, so that no key is that of nothing.
      const std::uint64_t key =
          std::uint64_t{below_[i] + 1} << 40 | std::uint64_t{number_above(meeting)} << 16 |
          std::uint64_t{static_cast<std::uint8_t>(meeting.relation)} << 8 | meeting.gap;
      pixels_[meeting.pixel] = number_of(key, [&] { return mix(mixtures_[below_[i]], meeting); });
    }
    last_key_ = 0;
  }

  const Paint& mixture(std::uint32_t number) const { return mixtures_[number]; }
  std::uint32_t mixture_at(std::uint32_t pixel) const {
    const std::uint32_t block = blocks_[pixel / kBlock];
    return block == kMixed ? pixels_[pixel] : block;
  }

  int width() const { return width_; }
  int height() const { return height_; }

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
  static constexpr std::uint32_t kNoRow = 0xffffffff;
  static constexpr std::size_t kMostRows = 1024;  // a megabyte

  template <typename Mix>
  void paint_block(std::size_t i, const std::uint8_t* values, const Mix& mix) {
    const std::uint64_t block = block_at(values);
    if (block == 0) return;
    std::uint32_t& mixture = blocks_[i];
    if (mixture != kMixed && block == (block & 0xff) * kEachByte) {
      mixture = mixture_for(mixture, values[0], mix);
      return;
    }
    std::uint32_t* pixels = pixels_.data() + i * kBlock;
    if (mixture != kMixed) std::fill_n(pixels, kBlock, mixture);
    mixture = kMixed;
    for (std::size_t k = 0; k < kBlock; ++k) {
      if (values[k] != 0) pixels[k] = mixture_for(pixels[k], values[k], mix);
    }
  }

  // The mixture that results from painting over a mixture at that value.
  template <typename Mix>
  std::uint32_t mixture_for(std::uint32_t below, std::uint8_t value, const Mix& mix) {
    std::uint32_t& row = row_of_[below];
    if (row == kNoRow) {
      if (rows_.size() == kMostRows * kValues) {
        return number_of(std::uint64_t{below} << 8 | value,
                         [&] { return mix(mixtures_[below], value); });
      }
      row = static_cast<std::uint32_t>(rows_.size());
      rows_.resize(rows_.size() + kValues);
    }
    std::uint32_t& number = rows_[row + value];
    if (number == 0) number = add(mix(mixtures_[below], value));
    return number;
  }

  std::uint32_t add(const Paint& mixture) {
    mixtures_.push_back(mixture);
    return static_cast<std::uint32_t>(mixtures_.size() - 1);
  }

  // The mixture of that key, which make() makes if it is new.
  template <typename Make>
  std::uint32_t number_of(std::uint64_t key, const Make& make) {
    if (key == last_key_) return last_mixture_;
    std::uint32_t& number = mixed_[key];
    if (number == 0) number = add(make());
    last_key_ = key;
    return last_mixture_ = number;
  }

  // Of the layers over the background.
  Rgba colour_of(const Paint& mixture) const {
    return to_rgba(mixed(mixture, 1, background_, 1.0f - mixture.covered + mixture.beneath));
  }

  // False if there are too many colours.
  bool to_indices(Picture& picture) {
    index_of_.assign(mixtures_.size(), kNoIndex);
    indices_by_colour_.clear();
    picture.indices.resize(pixels_.size());
    const bool is_done = translate(picture.indices.data(), [&](std::uint32_t mixture) {
      std::uint16_t& index = index_of_[mixture];
      if (index == kNoIndex) index = index_of(colour_of(mixtures_[mixture]), picture.palette);
      return index;
    });
    picture.indices.resize(is_done ? size_ : 0);
    if (!is_done) picture.palette.clear();
    return is_done;
  }

  void to_colours(Picture& picture) {
    colours_.resize(mixtures_.size());
    std::transform(mixtures_.begin(), mixtures_.end(), colours_.begin(),
                   [this](const Paint& mixture) { return colour_of(mixture); });
    picture.pixels.resize(pixels_.size());
    translate(picture.pixels.data(), [&](std::uint32_t mixture) { return colours_[mixture]; });
    picture.pixels.resize(size_);
  }

  // kValues if the palette is full.
  std::uint16_t index_of(Rgba colour, std::vector<Rgba>& palette) {
    std::uint32_t& number = indices_by_colour_[to_bits(colour)];  // counted from 1
    if (number == 0) {
      if (palette.size() == kValues) return kValues;
      palette.push_back(colour);
      number = static_cast<std::uint32_t>(palette.size());
    }
    return static_cast<std::uint16_t>(number - 1);
  }

  // Writes what `value_of` says of every pixel's mixture. Ends, false, when that is kValues.
  template <typename T, typename ValueOf>
  bool translate(T* out, ValueOf value_of) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i, out += kBlock) {
      const std::uint32_t* pixels = pixels_.data() + i * kBlock;
      const std::size_t count = blocks_[i] == kMixed ? kBlock : 1;
      for (std::size_t k = 0; k < count; ++k) {
        const auto value = value_of(count == 1 ? blocks_[i] : pixels[k]);
        if constexpr (std::is_integral_v<T>) {
          if (value == kValues) return false;
        }
        out[k] = static_cast<T>(value);
      }
      if (count == 1) std::fill_n(out + 1, kBlock - 1, out[0]);
    }
    return true;
  }

  int width_ = 0;
  int height_ = 0;
  std::size_t size_ = 0;  // in pixels
  Paint background_;
  std::vector<Paint> mixtures_;        // of number 0: what it begins with
  std::vector<std::uint32_t> blocks_;  // the mixture of eight pixels, or kMixed
  std::vector<std::uint32_t> pixels_;  // the mixtures of pixels in mixed blocks
  // For the layer of now: what becomes of a mixture at each value, and where to look for that by
  // mixture; of mixtures beyond the first so many, by mixture below and value.
  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> row_of_;
  NumberTable mixed_;
  std::uint64_t last_key_ = 0;
  std::uint32_t last_mixture_ = 0;
  std::vector<std::uint32_t> below_;     // the mixtures that note_below() found
  std::vector<std::uint16_t> index_of_;  // by mixture
  std::vector<Rgba> colours_;            // by mixture
  NumberTable indices_by_colour_;
};

namespace {

void require_size(const Mask* mask, int width, int height) {
  if (mask == nullptr) return;
  if (mask->width() != width || mask->height() != height) {
    throw std::invalid_argument("a mask is not as large as the picture");
  }
}

void require_size(const PaintedLayer& layer, int width, int height) {
  for (const PaintedClass& one : layer.classes) require_size(one.mask, width, height);
  for (const PaintedClass& one : layer.lines) require_size(one.mask, width, height);
  require_size(layer.pattern, width, height);
}

/// The function that lays a colour over a mixture.
auto laid_over(Rgba colour, double opacity = 1) {
  return [paints = paints_of(colour, static_cast<float>(opacity))](
             const Paint& below, std::uint8_t value) { return over(paints[value], below); };
}

/// A colour with a layer's pattern on it, by the values of their masks.
class PatternedPaints {
 public:
  PatternedPaints(Rgba colour, const PaintedLayer& layer)
      : fills_(paints_of(colour)),
        patterns_(paints_of(layer.pattern_colour)),
        opacity_(static_cast<float>(layer.opacity)) {}

  Paint at(std::uint8_t value, std::uint8_t pattern_value) const {
    return faded(within(patterns_[pattern_value], fills_[value]), opacity_);
  }

 private:
  std::array<Paint, kValues> fills_;
  std::array<Paint, kValues> patterns_;
  float opacity_;
};

std::uint8_t value_at(const Mask* mask, std::uint32_t pixel) {
  return mask == nullptr ? std::uint8_t{255} : mask->pixels()[pixel];
}

}  // namespace

Rgba Picture::at(int column, int row) const {
  const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(column);
  return is_indexed() ? palette[indices[i]] : pixels[i];
}

double covered_by(double below, double above, const Meeting& meeting) {
  const auto [covered, common] = shares_of(below, above, meeting);
  return above + covered - common;
}

std::vector<PaintedLayer> plain_layers(std::span<const PaintedClass> classes) {
  std::vector<PaintedLayer> layers(classes.size());
  for (std::size_t i = 0; i < classes.size(); ++i) layers[i].classes = classes.subspan(i, 1);
  return layers;
}

Composer::Composer() : canvas_(std::make_unique<Canvas>()), layer_(std::make_unique<Canvas>()) {}
Composer::~Composer() = default;
Composer::Composer(Composer&&) noexcept = default;
Composer& Composer::operator=(Composer&&) noexcept = default;

void Composer::compose(std::span<const PaintedLayer> layers, int width, int height, Rgba background,
                       Picture& picture) {
  canvas_->begin(width, height, background);
  for (const PaintedLayer& layer : layers) {
    require_size(layer, width, height);
    paint(layer);
  }
  canvas_->finish(picture);
}

void Composer::paint(const PaintedLayer& layer) {
  canvas_->note_below(layer.meetings);
  const bool is_separable = layer.lines.empty() || layer.opacity == 1;
  if (layer.classes.size() > 1 || !is_separable) return paint_together(layer);
  for (const PaintedClass& only : layer.classes) {
    if (layer.pattern != nullptr) {
      paint_patterned(only, layer);
    } else if (only.colour.a > 0) {
      paint_only(only, layer);
    }
  }
  for (const PaintedClass& line : layer.lines) {
    canvas_->paint(line.mask, laid_over(line.colour));
  }
}

void Composer::paint_only(const PaintedClass& only, const PaintedLayer& layer) {
  const auto paints = paints_of(only.colour, static_cast<float>(layer.opacity));
  canvas_->paint(only.mask, [&paints](const Paint& below, std::uint8_t value) {
    return over(paints[value], below);
  });
  const auto value_of = [&](const Meeting& meeting) { return value_at(only.mask, meeting.pixel); };
  canvas_->meet(layer.meetings, value_of, [&](const Paint& below, const Meeting& meeting) {
    return over(paints[value_of(meeting)], below, meeting);
  });
}

void Composer::paint_patterned(const PaintedClass& only, const PaintedLayer& layer) {
  const PatternedPaints paints(only.colour, layer);
  canvas_->paint(only.mask, *layer.pattern,
                 [&paints](const Paint& below, std::uint8_t value, std::uint8_t pattern_value) {
                   return over(paints.at(value, pattern_value), below);
                 });
  const auto values_of = [&](const Meeting& meeting) {
    return std::pair(value_at(only.mask, meeting.pixel), value_at(layer.pattern, meeting.pixel));
  };
  const auto number_of = [&](const Meeting& meeting) {
    const auto [value, pattern_value] = values_of(meeting);
    return std::uint32_t{value} << 8 | pattern_value;
  };
  canvas_->meet(layer.meetings, number_of, [&](const Paint& below, const Meeting& meeting) {
    const auto [value, pattern_value] = values_of(meeting);
    return over(paints.at(value, pattern_value), below, meeting);
  });
}

void Composer::paint_together(const PaintedLayer& layer) {
  layer_->begin(canvas_->width(), canvas_->height(), kTransparent);
  for (const PaintedClass& one : layer.classes) {
    layer_->paint(one.mask, [paints = paints_of(one.colour), is_beneath = one.is_beneath](
                                const Paint& below, std::uint8_t value) {
      return is_beneath ? added(paints[value], below) : beside(paints[value], below);
    });
  }
  layer_->change_all(settled);
  if (layer.pattern != nullptr) {
    layer_->paint(layer.pattern, [paints = paints_of(layer.pattern_colour)](const Paint& below,
                                                                            std::uint8_t value) {
      return within(paints[value], below);
    });
  }
  for (const PaintedClass& line : layer.lines) {
    layer_->paint(line.mask, laid_over(line.colour));
  }
  const auto opacity = static_cast<float>(layer.opacity);
  if (canvas_->is_blank()) {
    layer_->lie_over_blank(*canvas_, opacity);
    canvas_.swap(layer_);
    return;
  }
  canvas_->paint_over(*layer_, opacity);
  const auto number_of = [&](const Meeting& meeting) { return layer_->mixture_at(meeting.pixel); };
  canvas_->meet(layer.meetings, number_of, [&](const Paint& below, const Meeting& meeting) {
    return over(faded(layer_->mixture(number_of(meeting)), opacity), below, meeting);
  });
}

}  // namespace trapeze
