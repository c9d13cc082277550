// What is to be seen of features that lie over each other: in the part of a layer that a picture
// shows, the trapezoids of each less what is above it.
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

/// Use for one picture: note() every feature that is seen, settle(), add() the trapezoids of those
/// that are needed, resolve(). Holds working memory for reuse; one thread at a time.
class FeatureStack {
 public:
  /// How a feature is painted.
  struct Paint {
    std::uint32_t colour = 0;  // any number that tells its colour from others
    float opacity = 1;         // of its fill, 0 to 1
    bool is_raised = false;    // above all that are not

    bool is_opaque() const { return opacity >= 1; }
  };

  /// Begins anew. Overlaps narrower than `narrowest` cells are left as they are: at a tolerance,
  /// the borders of neighbours deviate by as much. So are those of features of one colour where all
  /// are opaque.
  void begin(const OverlapTable& overlaps, double narrowest);

  /// Takes notice of a feature, any number of times; paint_of(row) is called once.
  template <typename PaintOf>
  void note(std::uint32_t row, const PaintOf& paint_of);

  /// Finds out which features lie over which: whether there are any. A feature lies over those of
  /// lower rows, unless only the other is raised. Throws Cancelled.
  bool settle(const Cancellation* cancellation);

  /// After settle(), of a feature that has been noted.
  struct Role {
    bool is_cut = false;     // something lies over it
    bool is_needed = false;  // its trapezoids are to be added
  };
  Role role_of(std::uint32_t row) const;
  void add(std::uint32_t row, std::uint32_t trapezoid);

  /// Calls parts(row, trapezoids, parts) for every feature that is cut, in order of rows. Throws
  /// Cancelled.
  template <typename Parts>
  void resolve(const MeshView& mesh, const Cancellation* cancellation, const Parts& parts);

 private:
  struct Feature {
    std::uint32_t row = 0;
    Paint paint;
    Role role;
    std::vector<std::uint32_t> trapezoids;
    std::vector<std::uint32_t> covers;  // numbers of features
    Sheet sheet;
    bool has_sheet = false;

    void begin(std::uint32_t feature_row);
    bool is_below(const Feature& other) const;
  };

  static constexpr std::uint32_t kNone = 0xffffffff;

  std::size_t slot_of(std::uint32_t row) const;
  std::uint32_t find(std::uint32_t row) const;
  std::uint32_t insert(std::uint32_t row);
  void grow();
  static const Sheet& sheet_of(const MeshView& mesh, Feature& feature);
  void cut(const MeshView& mesh, Feature& feature, CancellationCheck& check);

  const OverlapTable* overlaps_ = nullptr;
  double narrowest_ = 0;
  std::deque<Feature> features_;  // the first count_
  std::uint32_t count_ = 0;
  std::vector<std::uint32_t> slots_;  // numbers of features by row, open addressing
  mutable std::uint32_t last_row_ = kNone;
  mutable std::uint32_t last_ = kNone;
  std::vector<std::uint32_t> by_row_;  // numbers of features in order of rows
  VisibleParts visible_;
};

template <typename PaintOf>
void FeatureStack::note(std::uint32_t row, const PaintOf& paint_of) {
  if (row == last_row_ || overlaps_->of(row).empty()) return;
  if (find(row) == kNone) features_[insert(row)].paint = paint_of(row);
}

template <typename Parts>
void FeatureStack::resolve(const MeshView& mesh, const Cancellation* cancellation,
                           const Parts& parts) {
  constexpr unsigned kStepsBetweenChecks = 4096;
  CancellationCheck check(cancellation, kStepsBetweenChecks);
  for (const std::uint32_t number : by_row_) {
    Feature& feature = features_[number];
    if (!feature.role.is_cut) continue;
    cut(mesh, feature, check);
    parts(feature.row, std::span<const std::uint32_t>(feature.trapezoids), visible_.parts());
  }
}

}  // namespace trapeze
