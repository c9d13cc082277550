// The visible parts of trapezoids that are overlapped by others.
//
// Trapezoids are cut along the sides of those above, at heights rounded to cells. The remaining
// parts are trapezoids between the same edges. So the parts of a trapezoid and the trapezoids that
// cut it fit together without gaps, and their areas add up, even where edges cross or run along
// each other.
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
  float share = 1;          // the fraction of its colour that is visible through the features above

  friend bool operator==(const TrapezoidPart&, const TrapezoidPart&) = default;
};

/// Non-overlapping trapezoids of one feature, indexed by height. Holds working memory for reuse.
class Sheet {
 public:
  /// Refers to trapezoids of `mesh`, which must outlive the use of the sheet.
  void assign(const MeshView& mesh, std::span<const std::uint32_t> trapezoids);

  struct Item {
    std::int32_t top;
    std::int32_t bottom;
    std::int32_t reach;  // the greatest bottom of the items up to this one
    std::uint32_t left;
    std::uint32_t right;
  };
  /// In order of their tops; without trapezoids that have no height.
  std::span<const Item> items() const { return items_; }

 private:
  std::vector<Item> items_;
};

/// The visible parts of trapezoids. One thread at a time.
class VisibleParts {
 public:
  /// A smaller fraction of a colour is invisible: half of the smallest step of 8 bits.
  static constexpr float kLeastShare = 0.5F / 255;

  /// Starts over, with a mesh that must outlive the use of the parts.
  void begin(const MeshView& mesh);

  /// Adds a whole trapezoid. Trapezoids without height have no parts.
  void add(std::uint32_t trapezoid);

  /// Covers the trapezoid added last with a sheet of the same mesh, through which the fraction
  /// `share`, 0 to 1, of everything below is visible. The parts below it keep that fraction, or
  /// disappear if less than kLeastShare of them is left: so the number of parts is bounded where
  /// many sheets overlap. Calls `check` for each trapezoid examined.
  void cover(const Sheet& sheet, float share, CancellationCheck& check);

  std::span<const TrapezoidPart> parts() const { return parts_; }

 private:
  // A part that has been compared with the items before `next`.
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
  std::size_t last_ = 0;  // index of the first part of the trapezoid added last
  std::vector<TrapezoidPart> covered_;
  std::vector<Pending> pending_;
};

}  // namespace trapeze
