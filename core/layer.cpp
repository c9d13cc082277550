#include "core/layer.h"

#include <utility>

#include "core/layer_contents.h"

namespace trapeze {

Layer::Layer(std::unique_ptr<const Contents> contents) : contents_(std::move(contents)) {}
Layer::~Layer() = default;

const FeatureTable& Layer::features() const { return contents_->features; }
const Box& Layer::bounds() const { return contents_->bounds; }
const MeshView& Layer::mesh() const { return contents_->view; }

void Layer::select(const Box& box, Level level, SmallPolygons small,
                   std::vector<TrapezoidRange>& ranges) const {
  ranges.clear();
  contents_->polygon_index.select(box, level, contents_->lifespans, ranges);
  if (small == SmallPolygons::dust) {
    contents_->dust_index.select(box, level, contents_->lifespans, ranges);
  }
}

void Layer::small_polygons(const Box& box, Level level, std::vector<Box>& places) const {
  places.clear();
  std::vector<TrapezoidRange> ranges;
  contents_->dust_index.select(box, level, contents_->lifespans, ranges);
  const MeshView& mesh = contents_->view;
  for (const TrapezoidRange& range : ranges) {
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      const MeshTrapezoid& t = mesh.trapezoids[i];
      const bool is_hole = mesh.vertices[mesh.edges[t.left].upper].x > mesh.vertices[mesh.edges[t.right].upper].x;
      if (!is_hole) places.push_back(box_of(mesh, t));
    }
  }
}

std::uint32_t Layer::feature_of(std::uint32_t trapezoid) const {
  return trapezoid < contents_->feature_of.size() ? contents_->feature_of[trapezoid] : kNoFeature;
}

Layer::Size Layer::size() const { return contents_->size; }

std::size_t Layer::memory() const {
  const Contents& c = *contents_;
  return c.vertices.capacity() * sizeof(Point) + c.edges.capacity() * sizeof(MeshEdge) +
         c.trapezoids.capacity() * sizeof(MeshTrapezoid) +
         c.lifespans.capacity() * sizeof(Lifespan) +
         c.feature_of.capacity() * sizeof(std::uint32_t) + c.polygon_index.memory() +
         c.dust_index.memory();
}

}  // namespace trapeze
