// Where the trapezoids of a mesh are and when they live: a packed tree over the array of
// trapezoids, which is ordered so that what is near in lifespan, size and place is near in the
// array.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/stored_array.h"
#include "core/grid/tolerance.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// The smallest box around a trapezoid, rounded outwards to whole cells.
Box box_of(const MeshView& mesh, const MeshTrapezoid& trapezoid);

/// True only if the trapezoids cover the box wholly; may be false though they do. Looks at no more
/// than a few dozen. None of them has negative area.
bool cover_box(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const Box& box);

/// Sorting by this key puts trapezoids that are drawn together next to each other: by the octave of
/// tolerance in which they die, then along a Hilbert curve. What lives long is large and sparse, so
/// the octave stands for the size too; finer classes (of birth, of size) cost more in branches of
/// the tree than they save.
std::uint64_t order_key(const Box& box, Lifespan lifespan);

/// Thread-safety: immutable, any number of threads may read.
class MeshIndex {
 public:
  /// What is known of all that lies below a place in the tree.
  struct Entry {
    Box box;
    Level min_born = kNeverDies;
    Level max_dies = 0;
    std::uint16_t unused = 0;  // in place of padding, so that equal entries are equal bytes
  };

  MeshIndex() = default;
  /// Over the trapezoids of `range`; `lifespans` has one for every trapezoid of the mesh.
  MeshIndex(const MeshView& mesh, TrapezoidRange range, std::span<const Lifespan> lifespans);
  /// One that looks at entries() of an index over as many trapezoids; they must outlive it. Throws
  /// std::invalid_argument if there are more or fewer.
  MeshIndex(TrapezoidRange range, std::span<const Entry> entries);

  /// Appends to `ranges` the trapezoids that are born at `born` or before, die after `alive`, and
  /// may meet `box`, as disjoint ranges in ascending order. With both levels equal: those alive
  /// there.
  void select(const Box& box, Level born, Level alive, std::span<const Lifespan> lifespans,
              std::vector<TrapezoidRange>& ranges) const;

  TrapezoidRange range() const { return range_; }
  /// Height after height, that over the trapezoids first.
  std::span<const Entry> entries() const { return entries_; }
  std::size_t memory() const { return entries_.memory(); }

 private:
  static constexpr std::size_t kFanout = 8;

  struct Query {
    const Box& box;
    Level born;
    Level alive;
    std::span<const Lifespan> lifespans;
    std::vector<TrapezoidRange>& ranges;
  };
  void descend(std::size_t height, std::size_t index, const Query& query) const;

  TrapezoidRange range_;
  StoredArray<Entry> entries_;
  std::vector<std::size_t> heights_;  // where each begins in the entries, and the end of the last
};

}  // namespace trapeze
