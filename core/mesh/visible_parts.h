// What is to be seen of trapezoids where others lie over them.
//
// Trapezoids are cut along the sides of those above, at heights rounded to cells; what is left are
// trapezoids between the same edges. So the parts of one and the trapezoids that cut it fit
// together without a gap, and their areas add up, wherever edges cross or run along each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// The part of a trapezoid between two heights and two edges.
struct TrapezoidPart {
  std::int32_t top = 0;     // y, in cells
  std::int32_t bottom = 0;  // below it
  std::uint32_t left = 0;   // index of an edge
  std::uint32_t right = 0;  // index of an edge
  float share = 1;          // of its colour that is seen through what lies over it

  friend bool operator==(const TrapezoidPart&, const TrapezoidPart&) = default;
};

/// Trapezoids of one feature, that do not overlap, to be found by height. Holds working memory for
/// reuse.
class Sheet {
 public:
  /// Looks at trapezoids of `mesh`, which must outlive the use of the sheet.
  void assign(const MeshView& mesh, std::span<const std::uint32_t> trapezoids);

  struct Item {
    std::int32_t top;
    std::int32_t bottom;
    std::int32_t reach;  // the greatest bottom of the items up to this one
    std::uint32_t left;
    std::uint32_t right;
  };
  /// In order of their tops; without those that have no height.
  std::span<const Item> items() const { return items_; }

 private:
  std::vector<Item> items_;
};

/// The parts of trapezoids that are to be seen. One thread at a time.
class VisibleParts {
 public:
  /// What is less of a colour is nothing: half of the smallest step of 8 bits.
  static constexpr float kLeastShare = 0.5F / 255;

  /// Begins without any, of a mesh which must outlive the use of the parts.
  void begin(const MeshView& mesh);

  /// Adds a trapezoid, whole. Those without height have no parts.
  void add(std::uint32_t trapezoid);

  /// Lays a sheet of the same mesh over the trapezoid that was added last: through it `share` of
  /// what lies below is seen, 0 to 1. Of the parts below it there remains that share, and nothing
  /// if less than kLeastShare is left of them: so the parts are bounded where many sheets lie over
  /// each other. `check` is called for each trapezoid that is looked at.
  void cover(const Sheet& sheet, float share, CancellationCheck& check);

  std::span<const TrapezoidPart> parts() const { return parts_; }

 private:
  // A part that has been held against the items before `next`.
  struct Pending {
    TrapezoidPart part;
    std::size_t next = 0;
  };

  void cover(const Pending& pending, std::span<const Sheet::Item> items, float share,
             CancellationCheck& check);
  bool cut(const TrapezoidPart& part, const Sheet::Item& above, float share, std::size_t next);
  void keep(const TrapezoidPart& part, std::size_t next);

  MeshView mesh_;
  std::vector<TrapezoidPart> parts_;
  std::size_t last_ = 0;  // where the parts of the trapezoid begin that was added last
  std::vector<TrapezoidPart> covered_;
  std::vector<Pending> pending_;
};

}  // namespace trapeze
