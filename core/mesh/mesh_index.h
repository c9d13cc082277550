// Finds trapezoids by place and lifespan: a packed tree of boxes over the array of trapezoids,
// which is sorted so that trapezoids of similar lifespan, size and place are near each other.
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

/// Whether a trapezoid whose left edge is to the west of its right one intersects the box. How a
/// polygon is divided into trapezoids does not matter: apart from rounding, one of them intersects
/// the box if the polygon does. False for a trapezoid without height.
bool meets(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Box& box);

/// True only if the trapezoids cover the whole box. May be false although they do, because only the
/// first few dozen are examined. None of them has negative area.
bool cover_box(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const Box& box);

/// Sorting by this key places trapezoids that are drawn together next to each other: by the octave
/// of tolerance in which they die, then along a Hilbert curve. Long-lived trapezoids are large and
/// sparse, so the octave also represents the size. Finer classes (of birth, of size) cost more in
/// branches of the tree than they save.
std::uint64_t order_key(const Box& box, Lifespan lifespan);

/// Thread-safety: immutable; any number of threads may read.
class MeshIndex {
 public:
  /// A node of the tree: the bounds of all trapezoids below it.
  struct Entry {
    Box box;
    Level min_born = kNeverDies;
    Level max_dies = 0;
    std::uint16_t unused = 0;  // instead of padding, so that equal entries are equal bytes
  };

  MeshIndex() = default;
  /// An index of the trapezoids of `range`; `lifespans` has one entry for every trapezoid of the
  /// mesh. Built on up to `threads` threads.
  MeshIndex(const MeshView& mesh, TrapezoidRange range, std::span<const Lifespan> lifespans,
            unsigned threads = 1);
  /// A view of the entries() of another index over as many trapezoids; they must outlive it. Throws
  /// std::invalid_argument if their number does not match that of the trapezoids.
  MeshIndex(TrapezoidRange range, std::span<const Entry> entries);

  /// Appends to `ranges` the trapezoids that are born at `born` or before, die after `alive`, and
  /// may intersect `box`, as disjoint ranges in ascending order. If `born` equals `alive`, these
  /// are the trapezoids alive at that level.
  void select(const Box& box, Level born, Level alive, std::span<const Lifespan> lifespans,
              std::vector<TrapezoidRange>& ranges) const;

  /// An estimate of the number of trapezoids that select() would append, found in a fraction of its
  /// time: within a third if there are hundreds. 0 only if there are none.
  std::uint64_t estimate(const Box& box, Level born, Level alive) const;

  TrapezoidRange range() const { return range_; }
  /// The levels of the tree one after another, starting with the one directly above the trapezoids.
  std::span<const Entry> entries() const { return entries_; }
  std::size_t memory() const { return entries_.memory(); }

 private:
  static constexpr std::size_t kFanout = 8;

  struct Wanted {
    Box box;
    Level born;
    Level alive;

    /// Without branches: which of eight entries match is hard to predict.
    bool meets(const Entry& entry) const {
      const Box& other = entry.box;
      return static_cast<int>(born >= entry.min_born) & static_cast<int>(alive < entry.max_dies) &
             static_cast<int>(box.min_x <= other.max_x) &
             static_cast<int>(other.min_x <= box.max_x) &
             static_cast<int>(box.min_y <= other.max_y) &
             static_cast<int>(other.min_y <= box.max_y);
    }
  };
  struct Query {
    const Wanted& wanted;
    std::span<const Lifespan> lifespans;
    std::vector<TrapezoidRange>& ranges;
  };
  /// The children of an entry that is not directly above trapezoids.
  std::span<const Entry> children(std::size_t height, std::size_t index) const;
  /// Searches below an entry that matches.
  void descend(std::size_t height, std::size_t index, const Query& query) const;
  /// Counts below an entry that matches and is not directly above trapezoids.
  std::uint64_t count_blocks(std::size_t height, std::size_t index, const Wanted& wanted) const;

  TrapezoidRange range_;
  StoredArray<Entry> entries_;
  std::vector<std::size_t> heights_;  // index of the first entry of each, and one past the last
};

}  // namespace trapeze
