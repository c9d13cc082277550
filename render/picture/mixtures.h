// Which values of which masks the pixels of a picture show, as runs of equal pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/number_table.h"
#include "render/picture/painted_layer.h"
#include "render/picture/picture.h"

namespace trapeze {

/// The layers of a picture, with a channel for each of their masks. Channel 0 is that of what
/// covers every pixel wholly. A view of the caller's layers.
class PictureParts {
 public:
  static constexpr std::uint32_t kWhole = 0;
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// A class of a layer, or one of its lines.
  struct Part {
    Rgba colour;
    bool is_beneath = false;
    std::uint32_t channel = kWhole;
  };
  struct Layer {
    const PaintedLayer* painted = nullptr;
    std::vector<Part> classes;
    std::vector<Part> lines;
    std::uint32_t pattern = kWhole;
    std::uint32_t meeting = kNone;  // number of its first value, see Mixtures
  };

  /// Throws std::invalid_argument if a mask is not of that size.
  void assign(std::span<const PaintedLayer> layers, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  std::span<const Layer> layers() const { return std::span(layers_).first(layer_count_); }
  const Mask* mask_of(std::uint32_t channel) const { return masks_[channel]; }
  std::uint32_t channel_count() const { return static_cast<std::uint32_t>(masks_.size()); }
  /// Of channels, by number, then two for each layer with meetings: relation and gap.
  std::size_t value_count() const { return value_count_; }

 private:
  std::uint32_t channel_of(const Mask* mask);

  int width_ = 0;
  int height_ = 0;
  std::vector<Layer> layers_;
  std::size_t layer_count_ = 0;
  std::vector<const Mask*> masks_;  // by channel; null for the first
  std::size_t value_count_ = 0;
};

/// A picture as runs of pixels that show the same mixture: the same values of all masks, where
/// layers meet in the same way.
struct Mixtures {
  std::size_t words_each = 0;
  std::vector<std::uint64_t> words;    // by mixture: its values, one after the other
  std::vector<std::uint32_t> pixels;   // by mixture: how many show it
  std::vector<Run> runs;               // of all rows; the number of a mixture in place of a colour
  std::vector<std::uint32_t> row_end;  // by row, the index after its last run

  std::size_t size() const { return pixels.size(); }
  /// Of PictureParts::value_count() values.
  const std::uint8_t* values_of(std::size_t mixture) const {
    return reinterpret_cast<const std::uint8_t*>(words.data() + mixture * words_each);
  }
};

/// Finds the mixtures of pictures one after the other, with working memory for reuse. One thread at
/// a time.
class MixtureFinder {
 public:
  void find(const PictureParts& parts, Mixtures& mixtures);

 private:
  // A channel that has values in the row.
  struct Source {
    const std::uint8_t* row = nullptr;
    std::uint32_t word = 0;
    std::uint32_t shift = 0;
  };
  struct LayerMeeting {
    std::size_t next = 0;  // the first that is not before the pixel at hand
    bool has_any = false;  // in the row
  };

  // Of mixtures of so many words; 0: however many.
  template <std::size_t kWords>
  void find_row(int row);
  template <std::size_t kWords>
  std::uint32_t mixture_at(std::size_t column, std::size_t pixel);
  template <std::size_t kWords>
  std::uint32_t number_of_key();
  void mark_layer(std::size_t number, int row);
  void mark_pattern(const PictureParts::Layer& layer, int row);
  void mark_meetings(std::size_t number, int row);
  void mark(std::uint32_t channel, int row, std::span<std::uint64_t> bits);
  void add_meetings(std::size_t pixel);
  void add_value(std::size_t number, std::uint8_t value);

  const PictureParts* parts_ = nullptr;
  Mixtures* mixtures_ = nullptr;
  std::size_t columns_ = 0;
  std::vector<std::uint64_t> changes_;  // by pixel of the row, as the next two
  std::vector<std::uint64_t> pattern_changes_;
  std::vector<std::uint64_t> covered_;
  std::vector<Source> sources_;
  std::vector<LayerMeeting> meetings_;  // by layer
  bool has_meetings_ = false;           // in the row
  std::vector<std::uint64_t> key_;      // of the mixture at hand
  NumberTable numbers_;
};

}  // namespace trapeze
