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
  if (mask->width() != width_ || mask->height() != height_) {
    throw std::invalid_argument("a mask is not as large as the picture");
  }
  masks_.push_back(mask);
  return static_cast<std::uint32_t>(masks_.size() - 1);
}

void MixtureFinder::find(const PictureParts& parts, Mixtures& mixtures) {
  parts_ = &parts;
  mixtures_ = &mixtures;
  columns_ = static_cast<std::size_t>(parts.width());
  mixtures.words_each = (parts.value_count() + kValuesAWord - 1) / kValuesAWord;
  mixtures.words.clear();
  mixtures.pixels.clear();
  mixtures.runs.clear();
  mixtures.row_end.clear();
  key_.resize(mixtures.words_each);
  changes_.resize(words_for(columns_));
  covered_.resize(words_for(columns_));
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

template <std::size_t kWords>
void MixtureFinder::find_row(int row) {
  std::fill(changes_.begin(), changes_.end(), 0);
  changes_[0] = 1;
  sources_.clear();
  has_meetings_ = false;
  for (std::size_t k = 0; k < parts_->layers().size(); ++k) mark_layer(k, row);
  const std::size_t first_pixel = static_cast<std::size_t>(row) * columns_;
  std::size_t begin = 0;
  std::uint32_t mixture = PictureParts::kNone;
  // The run that began last ends where the next one begins.
  const auto end_run = [&](std::size_t end) {
    mixtures_->pixels[mixture] += static_cast<std::uint32_t>(end - begin);
    mixtures_->runs.push_back({static_cast<std::uint32_t>(end), mixture});
  };
  for (std::size_t word = 0; word < changes_.size(); ++word) {
    for (std::uint64_t bits = changes_[word]; bits != 0; bits &= bits - 1) {
      const std::size_t column = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      const std::uint32_t next = mixture_at<kWords>(column, first_pixel + column);
      if (next == mixture) continue;
      if (column > 0) end_run(column);
      begin = column;
      mixture = next;
    }
  }
  end_run(columns_);
  mixtures_->row_end.push_back(static_cast<std::uint32_t>(mixtures_->runs.size()));
}

// Marks where the run at hand may end for what the layer shows in the row.
void MixtureFinder::mark_layer(std::size_t number, int row) {
  const PictureParts::Layer& layer = parts_->layers()[number];
  for (const PictureParts::Part& part : layer.classes) mark(part.channel, row, changes_);
  for (const PictureParts::Part& part : layer.lines) mark(part.channel, row, changes_);
  if (layer.pattern != PictureParts::kWhole) mark_pattern(layer, row);
  if (layer.meeting != PictureParts::kNone) mark_meetings(number, row);
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
    changes_[column / 64] |= std::uint64_t{1} << column % 64;
    if (column + 1 < columns_) {
      changes_[(column + 1) / 64] |= std::uint64_t{1} << (column + 1) % 64;
    }
  }
}

void MixtureFinder::mark(std::uint32_t channel, int row, std::span<std::uint64_t> bits) {
  if (channel == PictureParts::kWhole) return;
  const std::uint8_t* values = parts_->mask_of(channel)->row_begin(row);
  const bool has_changes = mark_changes({values, columns_}, bits);
  if (!has_changes && values[0] == 0) return;
  sources_.push_back({values, channel / kValuesAWord, channel % kValuesAWord * 8});
}

// A pattern matters only where the layer covers something.
void MixtureFinder::mark_pattern(const PictureParts::Layer& layer, int row) {
  std::fill(covered_.begin(), covered_.end(), 0);
  for (const PictureParts::Part& part : layer.classes) {
    if (part.channel == PictureParts::kWhole) {
      std::fill(covered_.begin(), covered_.end(), ~std::uint64_t{0});
    } else {
      mark_covered({parts_->mask_of(part.channel)->row_begin(row), columns_}, covered_);
    }
  }
  pattern_changes_.assign(changes_.size(), 0);
  mark(layer.pattern, row, pattern_changes_);
  for (std::size_t i = 0; i < changes_.size(); ++i) {
    changes_[i] |= pattern_changes_[i] & covered_[i];
  }
}

template <std::size_t kWords>
std::uint32_t MixtureFinder::mixture_at(std::size_t column, std::size_t pixel) {
  // Those of one word are most of all, and need no more than a register.
  if constexpr (kWords == 1) {
    std::uint64_t key = 255;
    for (const Source& source : sources_) key |= std::uint64_t{source.row[column]} << source.shift;
    key_[0] = key;
  } else {
    std::fill(key_.begin(), key_.end(), 0);
    key_[0] = 255;
    for (const Source& source : sources_) {
      key_[source.word] |= std::uint64_t{source.row[column]} << source.shift;
    }
  }
  if (has_meetings_) add_meetings(pixel);
  return number_of_key<kWords>();
}

void MixtureFinder::add_meetings(std::size_t pixel) {
  for (std::size_t k = 0; k < meetings_.size(); ++k) {
    auto& [next, has_any] = meetings_[k];
    if (!has_any) continue;
    const PictureParts::Layer& layer = parts_->layers()[k];
    const auto meetings = layer.painted->meetings;
    while (next < meetings.size() && meetings[next].pixel < pixel) ++next;
    if (next == meetings.size() || meetings[next].pixel != pixel) continue;
    add_value(layer.meeting, static_cast<std::uint8_t>(meetings[next].relation));
    add_value(layer.meeting + 1, meetings[next].gap);
  }
}

void MixtureFinder::add_value(std::size_t number, std::uint8_t value) {
  key_[number / kValuesAWord] |= std::uint64_t{value} << number % kValuesAWord * 8;
}

template <std::size_t kWords>
std::uint32_t MixtureFinder::number_of_key() {
  const std::size_t size = kWords == 1 ? 1 : key_.size();
  const std::span<const std::uint64_t> key(key_.data(), size);
  std::vector<std::uint64_t>& words = mixtures_->words;
  std::uint32_t& number = numbers_.find(hash_of(key), [&](std::uint32_t mixture) {
    return std::ranges::equal(key, std::span(words).subspan(mixture * size, size));
  });
  if (number == NumberTable::kNone) {
    number = static_cast<std::uint32_t>(mixtures_->size());
    words.insert(words.end(), key.begin(), key.end());
    mixtures_->pixels.push_back(0);
  }
  return number;
}

}  // namespace trapeze
