// Finds which values of which masks the pixels of a picture show, as runs of equal pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/number_table.h"
#include "render/picture/painted_layer.h"
#include "render/picture/picture.h"

namespace trapeze {

/// The layers of a picture, with a channel for each of their masks. Channel 0 represents full
/// coverage of every pixel. A view of the caller's layers.
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
    std::uint32_t meeting = kNone;  // index of its first value, see Mixtures
  };

  /// Throws std::invalid_argument if a mask has another size.
  void assign(std::span<const PaintedLayer> layers, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  std::span<const Layer> layers() const { return std::span(layers_).first(layer_count_); }
  /// Null for channel 0 and those of patterns.
  const Mask* mask_of(std::uint32_t channel) const { return masks_[channel]; }
  std::uint32_t channel_count() const { return static_cast<std::uint32_t>(masks_.size()); }
  /// One value per channel, followed by two for each layer with meetings: relation and gap.
  std::size_t value_count() const { return value_count_; }

 private:
  std::uint32_t channel_of(const Mask* mask);
  std::uint32_t channel_of(const PlacedPattern* pattern);
  void require_size(int width, int height) const;

  int width_ = 0;
  int height_ = 0;
  std::vector<Layer> layers_;
  std::size_t layer_count_ = 0;
  std::vector<const Mask*> masks_;  // by channel
  std::size_t value_count_ = 0;
};

/// A picture as runs of pixels with the same mixture: the same values of all masks, and the same
/// relations where layers meet.
struct Mixtures {
  std::size_t words_each = 0;
  std::vector<std::uint64_t> words;    // by mixture: its values, one after the other
  std::vector<std::uint32_t> pixels;   // by mixture: the number of pixels that show it
  std::vector<Run> runs;               // of all rows; with mixture numbers in place of colours
  std::vector<std::uint32_t> row_end;  // by row, the index after its last run

  std::size_t size() const { return pixels.size(); }
  /// PictureParts::value_count() values.
  const std::uint8_t* values_of(std::size_t mixture) const {
    return reinterpret_cast<const std::uint8_t*>(words.data() + mixture * words_each);
  }
};

/// Finds the mixtures of pictures one after the other, with reused working memory. One thread at a
/// time.
class MixtureFinder {
 public:
  void find(const PictureParts& parts, Mixtures& mixtures);

 private:
  // The position of the value of a channel in the words of a mixture.
  struct Place {
    std::uint32_t word = 0;
    std::uint32_t shift = 0;

    explicit Place(std::size_t number);
  };
  // A mask in the current row.
  struct MaskRow {
    const MaskRun* run = nullptr;  // at the current pixel
    Place place;
  };
  // A pattern in the current row.
  struct PatternRow {
    const std::uint8_t* values = nullptr;
    Place place;
  };
  struct LayerMeeting {
    std::size_t next = 0;  // the first one not before the current pixel
    bool has_any = false;  // in the row
  };

  // For mixtures of that many words; 0: any number.
  template <std::size_t kWords>
  std::size_t words_each() const {
    return kWords == 0 ? of_masks_.size() : kWords;
  }
  template <std::size_t kWords>
  void find_row(int row);
  template <std::size_t kWords>
  void number_row();
  template <std::size_t kWords>
  void put_key(std::size_t column, std::size_t pixel, std::uint64_t* key);
  std::uint32_t number_of_key(std::span<const std::uint64_t> key);
  void begin_row(int row);
  void mark_layer(std::size_t number, int row);
  void mark_mask(std::uint32_t channel, int row);
  void mark_pattern(std::size_t number, int row);
  void mark_meetings(std::size_t number, int row);
  void advance_masks(std::size_t column);
  void add_meetings(std::size_t pixel, std::uint64_t* key);

  const PictureParts* parts_ = nullptr;
  Mixtures* mixtures_ = nullptr;
  std::size_t columns_ = 0;
  std::vector<std::uint64_t> changes_;  // by pixel of the row
  std::vector<std::uint64_t> covered_;  // by pixel of the row, for the current layer
  std::vector<MaskRow> masks_;          // masks with values in the row
  std::vector<PatternRow> patterns_;
  std::vector<std::vector<std::uint8_t>> pattern_values_;  // by layer: for the pixels of the row
  std::vector<LayerMeeting> meetings_;                     // by layer
  bool has_meetings_ = false;                              // in the row
  std::vector<std::uint64_t>
      of_masks_;  // words of the current pixel, without patterns and meetings
  std::vector<std::uint64_t> row_keys_;  // of the runs of the row
  std::vector<std::uint32_t> row_ends_;  // the columns after them
  NumberTable numbers_;
};

}  // namespace trapeze
