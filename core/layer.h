// A layer ready to be drawn: the trapezoids of all its polygons, where they are, and its features.
//
// Thread-safety: immutable; any number of threads may read.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/feature_table.h"
#include "core/grid.h"
#include "core/tolerance.h"
#include "core/trapezoid_mesh.h"

namespace trapeze {

class Layer {
 public:
  struct Contents;  // the stored arrays; made by LayerBuilder

  explicit Layer(std::unique_ptr<const Contents> contents);
  ~Layer();
  Layer(const Layer&) = delete;
  Layer& operator=(const Layer&) = delete;

  const FeatureTable& features() const;
  /// The smallest box that holds all polygons; empty if there are none.
  const Box& bounds() const;
  const MeshView& mesh() const;

  /// Replaces `ranges` by the trapezoids of the mesh at `level` that may touch `box`, as disjoint
  /// ranges in ascending order. Never leaves out a trapezoid whose interior meets the box; may name
  /// a few that do not.
  void select(const Box& box, Level level, std::vector<TrapezoidRange>& ranges) const;

  /// The row, in features(), of the polygon that a trapezoid is a part of.
  std::uint32_t feature_of(std::uint32_t trapezoid) const;

  /// Heap memory held by geometry, index and attributes, in bytes.
  std::size_t memory() const;

 private:
  std::unique_ptr<const Contents> contents_;
};

}  // namespace trapeze
