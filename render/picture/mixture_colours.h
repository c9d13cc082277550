// The colours of mixtures of masks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/mixtures.h"
#include "render/picture/number_table.h"
#include "render/picture/paint.h"
#include "render/picture/reduce_colours.h"

namespace trapeze {

/// Computes the colours of the mixtures of pictures one after the other. One thread at a time.
class MixtureColours {
 public:
  /// Starts a picture over that background. Both arguments must live until the next call.
  void begin(const PictureParts& parts, const Mixtures& mixtures, Rgba background);

  /// The sum of the changes of all channels of all pixels if colours along edges may differ from
  /// the exact ones by at most that much.
  double change_along_edges(int most_change);
  /// Computes colours with that limit; all are exact if it is 0.
  void colour(int most_change);

  /// The colours computed last, by mixture.
  std::span<const Rgba> colours() const { return colours_; }
  std::span<const Origin> origins() const { return origins_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  // An edge is where one mask covers a part of the pixel, or where two are side by side and
  // together cover all of it. Whatever the other masks show, colours go in even steps from one side
  // to the other.
  struct Edge {
    Paint from;
    Paint to;
    bool is_on_line = false;  // otherwise colours in between do not follow the line
    float most_apart = 0;     // the greatest difference of a channel between the sides, of 255
    float sum_apart = 0;      // the sum of the differences
    bool is_opaque = false;   // on both sides
    // For the current limit:
    std::uint32_t steps = 1;
    float step = 1;                // share of one step
    std::uint32_t first_step = 0;  // index in step_mixtures_

    std::uint32_t nearest_step(std::uint8_t value) const { return (2 * value * steps + 255) / 510; }
    float nearest_share(std::uint8_t value) const {
      return static_cast<float>(nearest_step(value)) * step;
    }
    Paint between(float share) const { return mixed(to, share, from, 1 - share); }
  };

  // Properties of a mixture that do not depend on the limit.
  struct Kind {
    std::uint32_t edge = kNone;
    std::uint8_t value = 0;  // of the mask that has the edge
    bool has_meetings = false;
    bool is_exact_known = false;
    Origin origin = Origin::mixed;  // of the exact colour
    Rgba exact;
  };

  Kind kind_of(std::size_t mixture);
  bool is_edge_at_hand() const;
  std::uint32_t edge_at_hand();
  Edge make_edge();
  bool is_on_line(const Edge& edge);
  void set_steps(int most_change);
  void set_exact(std::size_t mixture, Rgba colour);
  void find_exact_in_lanes(std::span<const std::uint32_t> mixtures);
  void colour_along(const Edge& edge, std::size_t mixture);
  static bool is_close_once_rounded(const Edge& edge, std::uint8_t value);

  void take_values(std::size_t mixture);
  std::array<std::uint8_t, 2> exchange_values(std::array<std::uint8_t, 2> values);
  Paint mixture_with(std::array<std::uint8_t, 2> values);
  Paint mixture_at_hand() const;
  Paint with_layer(const PictureParts::Layer& layer, const Paint& below) const;
  Paint of_layer(const PictureParts::Layer& layer) const;
  Paint with_lines(const PictureParts::Layer& layer, Paint sum) const;
  Paint laid_over(const PictureParts::Layer& layer, const Paint& above, const Paint& below) const;
  Meeting meeting_of(const PictureParts::Layer& layer) const;
  float share_of(std::uint32_t channel) const { return static_cast<float>(values_[channel]) / 255; }

  const PictureParts* parts_ = nullptr;
  const Mixtures* mixtures_ = nullptr;
  Paint background_;
  bool are_layers_plain_ = false;
  // By word of a mixture: the highest bits of the values of channels, and of relations.
  std::vector<std::uint64_t> channel_bits_;
  std::vector<std::uint64_t> relation_bits_;
  std::vector<Kind> kinds_;  // by mixture
  std::vector<Edge> edges_;
  std::vector<std::uint64_t> edge_words_;  // the keys, by edge
  NumberTable edge_numbers_;
  std::vector<std::uint32_t> step_mixtures_;  // by step of all edges: a mixture with its colour
  std::vector<Rgba> colours_;                 // by mixture
  std::vector<Origin> origins_;               // by mixture
  std::vector<std::uint32_t> wanted_;         // mixtures whose exact colours are needed
  // For the current mixture.
  const std::uint8_t* values_ = nullptr;
  std::vector<std::uint64_t> words_;        // a modifiable copy of its values
  std::array<std::uint32_t, 2> partial_{};  // the first channels that partly cover the pixel
  std::size_t partial_count_ = 0;
  std::size_t meeting_count_ = 0;
};

}  // namespace trapeze
