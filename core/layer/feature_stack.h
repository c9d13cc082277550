// The visible parts of overlapping features: in the part of a layer that an image shows, the
// trapezoids of each feature minus the features above it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/layer/overlaps.h"
#include "core/mesh/trapezoid_mesh.h"
#include "core/mesh/visible_parts.h"

namespace trapeze {

/// Usage for one image: call note() for the feature of every visible trapezoid, then find_covers().
/// If that returns true, call note_place() for every trapezoid, settle(), add() for every trapezoid
/// again, and resolve(). Holds working memory for reuse. One thread at a time.
class FeatureStack {
 public:
  /// How a feature is painted.
  struct Paint {
    std::uint32_t colour = 0;  // any number that distinguishes its colour from others
    float opacity = 1;         // of its fill, 0 to 1
    bool is_raised = false;    // above all features that are not raised

    bool is_opaque() const { return opacity >= 1; }
  };

  struct Options {
    /// Overlaps narrower than so many cells are left as they are: at a tolerance, the borders of
    /// neighbours deviate by as much.
    double narrowest = 0;
    /// Whether a feature that is covered anywhere is cut up as a whole, and not only its trapezoids
    /// there.
    bool cuts_whole_features = false;
    /// Whether all features are opaque and of one colour.
    bool is_plain = false;
    /// Whether pixels are so small that boundaries which do not run along each other (see
    /// FeatureOverlap::along) share no pixels, except where they cross.
    bool is_fine = false;
  };

  /// Starts over with the trapezoids of a mesh; the arguments must outlive the use of the stack. If
  /// all features are opaque, those of one colour are cut only where their boundaries may run
  /// through the same pixels, because there their areas together exceed the area they cover.
  void begin(const OverlapTable& overlaps, const MeshView& mesh, const Options& options);

  /// Registers a feature; may be called repeatedly. paint_of(row) is called once for each feature.
  template <typename PaintOf>
  void note(std::uint32_t row, const PaintOf& paint_of);

  /// Finds which features are drawn over which ones anywhere, and returns whether there are any. A
  /// feature is drawn over those of lower rows, unless only the other is raised. Throws Cancelled.
  bool find_covers(const Cancellation* cancellation);

  /// After find_covers(): whether the stack handles places that features share (see
  /// FeatureOverlap::in_common()). If all features are opaque and none is cut up as a whole, the
  /// caller handles them, which only means leaving out the trapezoids below the uppermost one.
  bool covers_in_common() const { return covers_in_common_; }

  /// After find_covers(): registers the place of a trapezoid of a feature.
  void note_place(std::uint32_t row, std::uint32_t trapezoid);

  /// Finds which features are drawn over which ones where they are visible, and returns whether
  /// there are any.
  bool settle();

  /// After settle(): whether the feature is covered anywhere.
  bool is_cut(std::uint32_t row) const;

  /// After settle(), for every trapezoid that was registered. Returns true if it is cut up and must
  /// be drawn only as its parts.
  bool add(std::uint32_t row, std::uint32_t trapezoid);

  /// Calls parts(row, trapezoids, parts) for every feature that is cut, in order of rows, with
  /// those of its trapezoids that are cut up. Throws Cancelled.
  template <typename Parts>
  void resolve(const Cancellation* cancellation, const Parts& parts);

 private:
  struct Feature {
    std::uint32_t row = 0;
    Paint paint;
    Box box;                    // of its visible trapezoids
    bool is_in_a_pair = false;  // it is drawn over another one or under it
    bool is_over_others = false;
    std::vector<std::uint32_t> covers;      // numbers of the features over it, by the tops of their
                                            // boxes
    std::vector<std::uint32_t> trapezoids;  // all of them, if it is drawn over others
    std::vector<std::uint32_t> below;       // the trapezoids that are cut up
    Sheet sheet;
    bool has_sheet = false;

    void begin(std::uint32_t feature_row);
    bool is_below(const Feature& other) const;
  };

  static constexpr std::uint32_t kNone = 0xffffffff;

  bool can_matter(std::uint32_t row) const {
    return options_.is_plain && options_.is_fine ? overlaps_->runs_along_another(row)
                                                 : !overlaps_->of(row).empty();
  }
  Box box_around(std::uint32_t trapezoid) const;
  std::size_t slot_of(std::uint32_t row) const;
  std::uint32_t find(std::uint32_t row) const;
  std::uint32_t insert(std::uint32_t row);
  void grow();
  template <typename Visit>
  void for_each_cover(const Feature& feature, const Box& box, const Visit& visit) const;
  bool is_covered(const Feature& feature, std::uint32_t trapezoid) const;
  const Sheet& sheet_of(Feature& feature) const;
  void cut(Feature& feature, CancellationCheck& check);

  const OverlapTable* overlaps_ = nullptr;
  MeshView mesh_;
  Options options_;
  std::deque<Feature> features_;  // the first count_ are in use
  std::uint32_t count_ = 0;
  std::vector<std::uint32_t> slots_;  // numbers of features by row, open addressing
  bool covers_in_common_ = true;
  std::uint32_t last_noted_ = kNone;
  mutable std::uint32_t last_row_ = kNone;
  mutable std::uint32_t last_ = kNone;
  std::vector<std::uint32_t> by_row_;  // numbers of features in order of rows
  std::vector<std::uint32_t> over_;    // numbers of the features over a trapezoid
  VisibleParts visible_;
};

template <typename PaintOf>
void FeatureStack::note(std::uint32_t row, const PaintOf& paint_of) {
  if (row == last_noted_) return;
  last_noted_ = row;
  if (can_matter(row) && find(row) == kNone) features_[insert(row)].paint = paint_of(row);
}

template <typename Parts>
void FeatureStack::resolve(const Cancellation* cancellation, const Parts& parts) {
  constexpr unsigned kStepsBetweenChecks = 4096;
  CancellationCheck check(cancellation, kStepsBetweenChecks);
  for (const std::uint32_t number : by_row_) {
    Feature& feature = features_[number];
    if (feature.below.empty()) continue;
    cut(feature, check);
    parts(feature.row, std::span<const std::uint32_t>(feature.below), visible_.parts());
  }
}

}  // namespace trapeze
