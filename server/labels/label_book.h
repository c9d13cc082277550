// Labels that were placed, and how they look: kept so that a picture only looks up what reaches
// into it.
//
// A placement is of all layers of a picture that are labelled, in all of the world and at all
// scales; it depends neither on the picture nor on the zooms at which its layers are drawn.
//
// Thread-safety: all methods may be called from any thread; a call for what another thread is
// making waits for it.
#pragma once

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

/// The fonts that labels may be drawn in.
struct FontChoice {
  std::shared_ptr<const Fonts> usual = std::make_shared<const Fonts>();
  std::map<std::string, std::shared_ptr<const Fonts>> named = {};
};

/// A label as it looks at one scale. What it looks like is known by its identity before it is
/// drawn.
///
/// Thread-safety: any number of threads may read.
class LabelImage {
 public:
  struct Look {
    int width = 0;  // of the mask, in pixels
    int height = 0;
    Rgba letters;
    Rgba halo;
    std::string identity;  // equal for those that look the same, whoever drew them
  };
  /// `draw` makes the mask, in whatever thread first asks for it.
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

/// Where it lies in a picture: the column and the row of its north-west pixel, which may be
/// outside.
struct DrawnLabel {
  std::shared_ptr<const LabelImage> image;
  int left = 0;
  int top = 0;
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

  /// The labels that reach into the picture, in the order in which they are drawn.
  std::vector<DrawnLabel> find(const LabelledView& wanted);

  /// Whether any label may reach into the picture, or into one of the same place at a larger scale.
  bool is_any_from(const LabelledView& wanted);

  /// What find() costs before it can look anything up, in the units of drawing_cost(): nothing if
  /// the labels have been placed already.
  std::uint64_t cost_of(const LabelledView& wanted) const;

  /// Whether find() has nothing to place and nobody to wait for.
  bool has_placed(const LabelledView& wanted) const;

  /// Bytes held, about.
  std::size_t memory() const;

  static constexpr std::size_t kDefaultBudget = std::size_t{192} << 20;

 private:
  struct Placed;
  struct Entry;
  class Placing;

  static std::string key_of(const LabelledView& wanted);
  std::shared_ptr<const Placed> placed(const LabelledView& wanted);
  std::shared_ptr<const LabelAnchors> anchors_of(const ServedLayer& served, LabelParts parts);
  std::shared_ptr<Entry> entry(const std::string& key);
  void set_size(const std::string& key, std::shared_ptr<Entry> entry, std::size_t bytes);
  /// How large a text is.
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
  mutable std::mutex mutex_;  // guards all below
  mutable LruMap<std::string, std::shared_ptr<Entry>> kept_;
  LruMap<std::string, std::shared_ptr<const LabelImage>> images_;
  std::map<const Fonts*, std::string> identities_;
};

}  // namespace trapeze
