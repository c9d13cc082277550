// Where names of polygons go: for every part of a feature a point well inside of it.
//
// Names are wider than high. The point is the pole of inaccessibility of the part as it is when it
// is drawn kSqueeze times narrower: the centre of the largest ellipse, kSqueeze times as wide as
// high, that lies in it. Where other features of the layer lie over the feature, what is seen of it
// counts.
//
// The point is found on the polygon at full detail, and is the same at all scales, so that a name
// stays where it is while one zooms. A boundary that is simplified within less than the depth of
// the point does not pass it: so the point is inside the generalized polygon as long as the depth
// is more than the tolerance.
//
// Thread-safety: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/rings.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Which parts of a feature have an anchor.
enum class LabelParts : std::uint8_t { largest, all };

struct LabelAnchor {
  std::uint32_t row = 0;  // of the feature
  Point place;
  /// Half the height of the ellipse, in cells, which is half its width divided by kSqueeze. Within
  /// kDepthShare of the greatest. No boundary is nearer than that, but for small rings, which may
  /// be kSmallRings times as near.
  float depth = 0;
  float area = 0;  // of the part, its holes left out, in square cells

  friend bool operator==(const LabelAnchor&, const LabelAnchor&) = default;
};

/// What was found of a layer before.
struct KnownAnchors {
  const Layer* layer = nullptr;
  std::span<const LabelAnchor> of_all_parts;  // in order of rows; empty: nothing is known
};

class LabelAnchors {
 public:
  /// Width by height of the ellipse.
  static constexpr double kSqueeze = 3;
  /// Holes that are smaller than such a share of the part, and features over it that are, may lie
  /// within the ellipse: it keeps away from them by kSmallRings times less.
  static constexpr double kSmallShare = 0.02;
  static constexpr double kSmallRings = 8;
  /// How much deeper a point might be found, as a share of the depth.
  static constexpr double kDepthShare = 0.04;

  /// Of all features that there are, on up to `threads` threads, on which nothing depends. A part
  /// without any inside that is seen has none, and one of which next to nothing is seen may have
  /// none; of a feature whose largest part has none, the next.
  LabelAnchors(const Layer& layer, LabelParts parts, unsigned threads = 1);
  /// Those of all parts; of features whose outlines, and those of the features over them, are as
  /// they were in a layer that has been looked at before, they are not sought again. Equal to
  /// finding all.
  LabelAnchors(const Layer& layer, const KnownAnchors& known, unsigned threads = 1);
  /// Those of a layer of which all parts have been looked at before: equal to finding them.
  LabelAnchors(std::span<const LabelAnchor> of_all_parts, LabelParts parts);

  /// In order of rows; those of one feature by area, the largest part first.
  std::span<const LabelAnchor> all() const { return anchors_; }
  std::size_t memory() const { return anchors_.capacity() * sizeof(LabelAnchor); }

 private:
  std::vector<LabelAnchor> anchors_;
};

/// The anchors of one feature, by area, the largest part first. Rings as Layer::append_outline()
/// gives them: nested by even-odd and without crossings. `above` are rings of the features over it,
/// each of them apart.
std::vector<LabelAnchor> anchors_of_feature(std::uint32_t row, const Rings& rings,
                                            std::span<const Rings> above = {},
                                            LabelParts parts = LabelParts::all);

}  // namespace trapeze
