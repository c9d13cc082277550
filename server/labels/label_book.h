// Placed labels and their appearance, cached so that a picture only looks up the labels that reach
// into it.
//
// A placement covers all labelled layers of a picture, for the whole world and all scales. It
// depends neither on the picture nor on the zooms at which its layers are drawn.
//
// Thread-safety: all methods may be called from any thread; a call that needs the result of another
// thread's work in progress waits for it.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/labels/label_anchors.h"
#include "core/labels/label_placement.h"
#include "render/mask/mask.h"
#include "render/text/fonts.h"
#include "server/base/lru_map.h"
#include "server/data/dataset.h"
#include "server/labels/label_style.h"

namespace trapeze {

/// The fonts available for labels.
struct FontChoice {
  std::shared_ptr<const Fonts> usual = std::make_shared<const Fonts>();
  std::map<std::string, std::shared_ptr<const Fonts>> named = {};
};

/// The appearance of a label at one scale. Its identity is known before it is drawn.
///
/// Thread-safety: any number of threads may read.
class LabelImage {
 public:
  struct Look {
    int width = 0;  // of the mask, in pixels
    int height = 0;
    Rgba letters;
    Rgba halo;
    std::string identity;  // equal for images that look the same, whoever drew them
  };
  /// `draw` creates the mask, in the thread that needs it first.
  LabelImage(Look look, std::function<TextMask()> draw)
      : look_(std::move(look)), draw_(std::move(draw)) {}

  const Look& look() const { return look_; }
  const TextMask& mask() const {
    std::call_once(once_, [this] { mask_ = draw_(); });
    return mask_;
  }

 private:
  const Look look_;
  const std::function<TextMask()> draw_;
  mutable std::once_flag once_;
  mutable TextMask mask_;
};

/// A label placed in a picture: column and row of its north-west pixel, which may be outside.
struct DrawnLabel {
  std::shared_ptr<const LabelImage> image;
  int left = 0;
  int top = 0;
};

/// A label where it is placed on the plane, for comparing two states of a layer.
struct PlacedLabel {
  double x = 0;  // of its middle, in cells
  double y = 0;
  double half_width = 0;  // in cells at a certain scale; no ink is farther away
  double half_height = 0;
  std::uint32_t layer = 0;  // among the labelled layers
  std::string text;

  friend auto operator<=>(const PlacedLabel&, const PlacedLabel&) = default;
};

/// A picture, or a part of one, with its labels. `layers` are those of the plan, bottom first.
struct LabelledView {
  const Dataset& dataset;
  std::span<const LabelledLayer> layers;
  View view;
  double scale = 1;
};

class LabelBook {
 public:
  explicit LabelBook(FontChoice fonts = {}, std::size_t budget = kDefaultBudget);
  ~LabelBook();

  const std::shared_ptr<const Fonts>& usual_fonts() const { return fonts_.usual; }

  /// Equal for fonts and libraries that draw all labels in the same way.
  std::string identity_of_fonts() const;

  /// The labels that reach into the picture, in drawing order.
  std::vector<DrawnLabel> find(const LabelledView& wanted);

  /// All labels, in any order, that are shown in pictures of that scale, wherever they are.
  std::vector<PlacedLabel> all_at_scale_of(const LabelledView& wanted);

  /// Whether any label may reach into the picture, or into one of the same place at a larger scale.
  bool is_any_from(const LabelledView& wanted);

  /// The cost of find(), in units of drawing_cost(), apart from the look-up; 0 if the labels have
  /// already been placed.
  std::uint64_t cost_of(const LabelledView& wanted) const;

  /// Whether find() neither has to place labels nor to wait for another thread.
  bool has_placed(const LabelledView& wanted) const;

  /// Approximate memory in bytes.
  std::size_t memory() const;

  static constexpr std::size_t kDefaultBudget = std::size_t{192} << 20;

 private:
  struct Placed;
  struct Entry;
  class Placing;

  using Entries = LruMap<std::string, std::shared_ptr<Entry>>;

  static std::string key_of(const LabelledView& wanted);
  std::shared_ptr<const Placed> placed(const LabelledView& wanted);
  std::shared_ptr<const LabelAnchors> anchors_of(const ServedLayer& served, LabelParts parts);
  std::shared_ptr<Entry> entry(Entries& entries, const std::string& key);
  void set_size(Entries& entries, const std::string& key, std::shared_ptr<Entry> entry,
                std::size_t bytes);
  /// The size of a text.
  struct Room {
    double width = 0;   // pixels, without halo
    double height = 0;  // the same
  };
  std::shared_ptr<const LabelImage> image_of(const LabelledLayer& layer,
                                             const FeatureTable& features, std::uint32_t row,
                                             const Room& room, double scale);
  const std::shared_ptr<const Fonts>& fonts_for(const LabelStyle& style) const;
  const std::string& identity_of(const Fonts& fonts);

  const FontChoice fonts_;
  mutable std::mutex mutex_;  // guards everything below
  mutable Entries kept_;
  // Apart from the placements: finding anchors takes many times as long as placing labels, and
  // styles, which anybody can make up, must not displace them.
  Entries anchors_;
  LruMap<std::string, std::shared_ptr<const LabelImage>> images_;
  std::map<const Fonts*, std::string> identities_;
};

}  // namespace trapeze
