// The colours that mixtures of masks show.
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

/// Colours the mixtures of one picture after the other. One thread at a time.
class MixtureColours {
 public:
  /// Of a picture over that background. Both arguments are looked at until the next call.
  void begin(const PictureParts& parts, const Mixtures& mixtures, Rgba background);

  /// The sum of the changes of all channels of all pixels, if along edges they become at most so
  /// far from the exact ones.
  double change_along_edges(int most_change);
  /// Chooses colours by that; all are exact if it is 0.
  void colour(int most_change);

  /// As they became last, by mixture.
  std::span<const Rgba> colours() const { return colours_; }
  std::span<const Origin> origins() const { return origins_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  // An edge is where one mask has a part of the pixel, or where two lie side by side and have all
  // of it together. Whatever the others show, colours go in even steps from one side to the other.
  struct Edge {
    Paint from;
    Paint to;
    bool is_on_line = false;  // else colours between the two are others
    float most_apart = 0;     // of both sides: the greatest difference of a channel, of 255
    float sum_apart = 0;      // the sum of the differences
    bool is_opaque = false;   // on both sides
    // For the change at hand:
    std::uint32_t steps = 1;
    float step = 1;                // the share of one
    std::uint32_t first_step = 0;  // index in step_mixtures_

    std::uint32_t nearest_step(std::uint8_t value) const { return (2 * value * steps + 255) / 510; }
    float nearest_share(std::uint8_t value) const {
      return static_cast<float>(nearest_step(value)) * step;
    }
    Paint between(float share) const { return mixed(to, share, from, 1 - share); }
  };

  // What is known of a mixture whatever the change.
  struct Kind {
    std::uint32_t edge = kNone;
    std::uint8_t value = 0;  // of the mask whose edge it is
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
  std::vector<std::uint64_t> edge_words_;  // by edge: its key
  NumberTable edge_numbers_;
  std::vector<std::uint32_t> step_mixtures_;  // by step of all edges: one that has its colour
  std::vector<Rgba> colours_;                 // by mixture
  std::vector<Origin> origins_;               // by mixture
  std::vector<std::uint32_t> wanted_;         // mixtures whose exact colours are to be found
  // Of the mixture at hand.
  const std::uint8_t* values_ = nullptr;
  std::vector<std::uint64_t> words_;        // a copy of its values that may be changed
  std::array<std::uint32_t, 2> partial_{};  // the first channels that have a part of the pixel
  std::size_t partial_count_ = 0;
  std::size_t meeting_count_ = 0;
};

}  // namespace trapeze
