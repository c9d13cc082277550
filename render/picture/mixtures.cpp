#include "render/picture/mixtures.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "render/mask/row_bits.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kValuesAWord = sizeof(std::uint64_t);
static_assert(std::endian::native == std::endian::little);

}  // namespace

void PictureParts::assign(std::span<const PaintedLayer> layers, int width, int height) {
  width_ = width;
  height_ = height;
  masks_.assign(1, nullptr);
  layer_count_ = layers.size();
  if (layers_.size() < layer_count_) layers_.resize(layer_count_);
  for (std::size_t k = 0; k < layer_count_; ++k) {
    const PaintedLayer& painted = layers[k];
    Layer& layer = layers_[k];
    layer.painted = &painted;
    layer.classes.clear();
    layer.lines.clear();
    for (const PaintedClass& one : painted.classes) {
      layer.classes.push_back({one.colour, one.is_beneath, channel_of(one.mask)});
    }
    for (const PaintedClass& one : painted.lines) {
      layer.lines.push_back({one.colour, false, channel_of(one.mask)});
    }
    layer.pattern = channel_of(painted.pattern);
  }
  value_count_ = masks_.size();
  for (Layer& layer : std::span(layers_).first(layer_count_)) {
    layer.meeting = kNone;
    if (layer.painted->meetings.empty()) continue;
    layer.meeting = static_cast<std::uint32_t>(value_count_);
    value_count_ += 2;
  }
}

std::uint32_t PictureParts::channel_of(const Mask* mask) {
  if (mask == nullptr) return kWhole;
  require_size(mask->width(), mask->height());
  masks_.push_back(mask);
  return static_cast<std::uint32_t>(masks_.size() - 1);
}

std::uint32_t PictureParts::channel_of(const PlacedPattern* pattern) {
  if (pattern == nullptr) return kWhole;
  require_size(pattern->width(), pattern->height());
  masks_.push_back(nullptr);
  return static_cast<std::uint32_t>(masks_.size() - 1);
}

void PictureParts::require_size(int width, int height) const {
  if (width == width_ && height == height_) return;
  throw std::invalid_argument("a mask is not as large as the picture");
}

MixtureFinder::Place::Place(std::size_t number)
    : word(static_cast<std::uint32_t>(number / kValuesAWord)),
      shift(static_cast<std::uint32_t>(number % kValuesAWord * 8)) {}

void MixtureFinder::find(const PictureParts& parts, Mixtures& mixtures) {
  parts_ = &parts;
  mixtures_ = &mixtures;
  columns_ = static_cast<std::size_t>(parts.width());
  mixtures.words_each = (parts.value_count() + kValuesAWord - 1) / kValuesAWord;
  mixtures.words.clear();
  mixtures.pixels.clear();
  mixtures.runs.clear();
  mixtures.row_end.clear();
  of_masks_.resize(mixtures.words_each);
  row_keys_.resize((columns_ + 1) * mixtures.words_each);
  changes_.resize(words_for(columns_));
  covered_.resize(words_for(columns_));
  if (pattern_values_.size() < parts.layers().size()) pattern_values_.resize(parts.layers().size());
  meetings_.assign(parts.layers().size(), {});
  numbers_.clear();
  for (int row = 0; row < parts.height(); ++row) {
    if (mixtures.words_each == 1) {
      find_row<1>(row);
    } else {
      find_row<0>(row);
    }
  }
}

// Computes the keys of the whole row first, so that all of their slots can be prefetched.
template <std::size_t kWords>
void MixtureFinder::find_row(int row) {
  begin_row(row);
  const std::size_t first_pixel = static_cast<std::size_t>(row) * columns_;
  std::uint64_t* key = row_keys_.data();  // of the current run
  put_key<kWords>(0, first_pixel, key);
  numbers_.prefetch(hash_of({key, words_each<kWords>()}));
  for_each_bit(changes_, [&](std::size_t column) {
    const std::size_t words = words_each<kWords>();
    advance_masks(column);
    std::uint64_t* const next = key + words;
    put_key<kWords>(column, first_pixel + column, next);
    if (std::equal(key, key + words, next)) return;
    numbers_.prefetch(hash_of({next, words}));
    row_ends_.push_back(static_cast<std::uint32_t>(column));
    key = next;
  });
  row_ends_.push_back(static_cast<std::uint32_t>(columns_));
  number_row<kWords>();
}

// Inlined, so that the number of words is a constant if the caller knows it.
[[gnu::always_inline]] inline std::uint32_t MixtureFinder::number_of_key(
    std::span<const std::uint64_t> key) {
  std::vector<std::uint64_t>& words = mixtures_->words;
  std::uint32_t& number = numbers_.find(hash_of(key), [&](std::uint32_t mixture) {
    return std::equal(key.begin(), key.end(), words.data() + mixture * key.size());
  });
  if (number == NumberTable::kNone) {
    number = static_cast<std::uint32_t>(mixtures_->size());
    for (const std::uint64_t word : key) words.push_back(word);
    mixtures_->pixels.push_back(0);
  }
  return number;
}

template <std::size_t kWords>
void MixtureFinder::number_row() {
  const std::size_t words = words_each<kWords>();
  const std::uint64_t* key = row_keys_.data();
  std::uint32_t begin = 0;
  for (const std::uint32_t end : row_ends_) {
    const std::uint32_t mixture = number_of_key({key, words});
    mixtures_->pixels[mixture] += end - begin;
    mixtures_->runs.push_back({end, mixture});
    begin = end;
    key += words;
  }
  mixtures_->row_end.push_back(static_cast<std::uint32_t>(mixtures_->runs.size()));
}

// Marks where runs may end, and sets the masks to the first pixel.
void MixtureFinder::begin_row(int row) {
  std::fill(changes_.begin(), changes_.end(), 0);
  masks_.clear();
  patterns_.clear();
  row_ends_.clear();
  has_meetings_ = false;
  std::fill(of_masks_.begin(), of_masks_.end(), 0);
  of_masks_[0] = 255;
  for (std::size_t k = 0; k < parts_->layers().size(); ++k) mark_layer(k, row);
}

// Marks where the current run may end because of the layer's contents in the row.
void MixtureFinder::mark_layer(std::size_t number, int row) {
  const PictureParts::Layer& layer = parts_->layers()[number];
  for (const PictureParts::Part& part : layer.classes) mark_mask(part.channel, row);
  for (const PictureParts::Part& part : layer.lines) mark_mask(part.channel, row);
  if (layer.pattern != PictureParts::kWhole) mark_pattern(number, row);
  if (layer.meeting != PictureParts::kNone) mark_meetings(number, row);
}

void MixtureFinder::mark_mask(std::uint32_t channel, int row) {
  if (channel == PictureParts::kWhole) return;
  const auto runs = parts_->mask_of(channel)->row(row);
  if (runs.size() == 1 && runs.front().value == 0) return;
  mark_changes(runs, changes_);
  const Place place(channel);
  of_masks_[place.word] |= std::uint64_t{runs.front().value} << place.shift;
  if (runs.size() > 1) masks_.push_back({runs.data(), place});
}

// A pattern matters, and is drawn, only where the layer covers something.
void MixtureFinder::mark_pattern(std::size_t number, int row) {
  const PictureParts::Layer& layer = parts_->layers()[number];
  std::fill(covered_.begin(), covered_.end(), 0);
  for (const PictureParts::Part& part : layer.classes) {
    if (part.channel == PictureParts::kWhole) {
      set_bits(0, columns_, covered_);
    } else {
      mark_covered(parts_->mask_of(part.channel)->row(row), covered_);
    }
  }
  std::vector<std::uint8_t>& values = pattern_values_[number];
  values.assign(columns_, 0);
  bool has_any = false;
  for_each_run_of_bits(covered_, columns_, [&](std::size_t begin, std::size_t end) {
    layer.painted->pattern->draw(row, begin, end, values.data());
    for (std::size_t i = std::max<std::size_t>(begin, 1); i < end; ++i) {
      if (values[i] != values[i - 1]) set_bits(i, i + 1, changes_);
    }
    if (end < columns_) set_bits(end, end + 1, changes_);
    has_any = true;
  });
  if (has_any) patterns_.push_back({values.data(), Place(layer.pattern)});
}

void MixtureFinder::mark_meetings(std::size_t number, int row) {
  const auto meetings = parts_->layers()[number].painted->meetings;
  const std::size_t end = (static_cast<std::size_t>(row) + 1) * columns_;
  const std::size_t begin = end - columns_;
  auto& [next, has_any] = meetings_[number];
  while (next < meetings.size() && meetings[next].pixel < begin) ++next;
  has_any = next < meetings.size() && meetings[next].pixel < end;
  has_meetings_ = has_meetings_ || has_any;
  for (std::size_t i = next; i < meetings.size() && meetings[i].pixel < end; ++i) {
    const std::size_t column = meetings[i].pixel - begin;
    set_bits(column, std::min(column + 2, columns_), changes_);
  }
}

// Advances to a column where any of them may change.
void MixtureFinder::advance_masks(std::size_t column) {
  for (MaskRow& mask : masks_) {
    if (mask.run->end > column) continue;
    const unsigned change = mask.run[0].value ^ mask.run[1].value;
    of_masks_[mask.place.word] ^= std::uint64_t{change} << mask.place.shift;
    ++mask.run;
  }
}

/// For the current pixel.
template <std::size_t kWords>
inline void MixtureFinder::put_key(std::size_t column, std::size_t pixel, std::uint64_t* key) {
  if constexpr (kWords == 1) {
    key[0] = of_masks_[0];
  } else {
    std::ranges::copy(of_masks_, key);
  }
  for (const PatternRow& pattern : patterns_) {
    key[pattern.place.word] |= std::uint64_t{pattern.values[column]} << pattern.place.shift;
  }
  if (has_meetings_) add_meetings(pixel, key);
}

void MixtureFinder::add_meetings(std::size_t pixel, std::uint64_t* key) {
  for (std::size_t k = 0; k < meetings_.size(); ++k) {
    auto& [next, has_any] = meetings_[k];
    if (!has_any) continue;
    const PictureParts::Layer& layer = parts_->layers()[k];
    const auto meetings = layer.painted->meetings;
    while (next < meetings.size() && meetings[next].pixel < pixel) ++next;
    if (next == meetings.size() || meetings[next].pixel != pixel) continue;
    const auto add_value = [key](std::size_t number, std::uint8_t value) {
      const Place place(number);
      key[place.word] |= std::uint64_t{value} << place.shift;
    };
    add_value(layer.meeting, static_cast<std::uint8_t>(meetings[next].relation));
    add_value(layer.meeting + 1, meetings[next].gap);
  }
}

}  // namespace trapeze
