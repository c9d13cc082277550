// Where labels of polygons are placed: for every part of a feature, a point well inside it.
//
// Labels are wider than high. The point is the pole of inaccessibility of the part drawn kSqueeze
// times narrower: the centre of the largest ellipse, kSqueeze times as wide as high, that lies in
// the part. If other features of the layer overlap the feature, only its visible area counts.
//
// The point is found on the polygon at full detail and is the same at all scales, so a label stays
// in place while the user zooms. A boundary that is simplified by less than the depth of the point
// does not pass over it: the point is inside the generalized polygon as long as the depth is more
// than the tolerance.
//
// Thread-safety: may be called from any thread.
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
  std::uint32_t row = 0;  // row of the feature
  Point place;
  /// Half the height of the ellipse, in cells, which is half its width divided by kSqueeze. Within
  /// kDepthShare of the maximum. No boundary is nearer than that, except small rings, which may be
  /// kSmallRings times as near.
  float depth = 0;
  float area = 0;  // of the part without its holes, in square cells

  friend bool operator==(const LabelAnchor&, const LabelAnchor&) = default;
};

/// The anchors already found for an earlier layer.
struct KnownAnchors {
  const Layer* layer = nullptr;
  std::span<const LabelAnchor> of_all_parts;  // in order of rows; empty: nothing is known
};

class LabelAnchors {
 public:
  /// Width of the ellipse divided by its height.
  static constexpr double kSqueeze = 3;
  /// Holes, and features drawn over the part, that are smaller than this fraction of it may lie
  /// within the ellipse: the distance kept from them is divided by kSmallRings.
  static constexpr double kSmallShare = 0.02;
  static constexpr double kSmallRings = 8;
  /// By how much a deeper point might exceed the depth, as a fraction of it.
  static constexpr double kDepthShare = 0.04;

  /// The anchors of all existing features, found on up to `threads` threads; the result does not
  /// depend on their number. A part without visible interior has none, and one of which almost
  /// nothing is visible may have none; if the largest part of a feature has none, the next one
  /// counts.
  LabelAnchors(const Layer& layer, LabelParts parts, unsigned threads = 1);
  /// The anchors of all parts. Features whose outlines, and those of the features over them, are
  /// unchanged from the layer of `known` are not searched again. The result equals that of a full
  /// search.
  LabelAnchors(const Layer& layer, const KnownAnchors& known, unsigned threads = 1);
  /// From the anchors of all parts of a layer, found before. The result equals that of a search.
  LabelAnchors(std::span<const LabelAnchor> of_all_parts, LabelParts parts);

  /// In order of rows; those of one feature by area, the largest part first.
  std::span<const LabelAnchor> all() const { return anchors_; }
  std::size_t memory() const { return anchors_.capacity() * sizeof(LabelAnchor); }

 private:
  std::vector<LabelAnchor> anchors_;
};

/// The anchors of one feature, by area, the largest part first. Rings are as appended by
/// Layer::append_outline(): nested by even-odd and without crossings. `above` are rings of the
/// features over it, one entry per feature.
std::vector<LabelAnchor> anchors_of_feature(std::uint32_t row, const Rings& rings,
                                            std::span<const Rings> above = {},
                                            LabelParts parts = LabelParts::all);

}  // namespace trapeze
