#include "core/layer.h"

#include <utility>

#include "core/layer_contents.h"

namespace trapeze {

Layer::Layer(std::unique_ptr<const Contents> contents) : contents_(std::move(contents)) {}
Layer::~Layer() = default;

const FeatureTable& Layer::features() const { return contents_->features; }
const Box& Layer::bounds() const { return contents_->bounds; }
const MeshView& Layer::mesh() const { return contents_->view; }

void Layer::select(const Box& box, Level level, std::vector<TrapezoidRange>& ranges) const {
  contents_->index.select(box, level, contents_->lifespans, ranges);
}

std::uint32_t Layer::feature_of(std::uint32_t trapezoid) const {
  return contents_->feature_of[trapezoid];
}

std::size_t Layer::memory() const {
  const Contents& c = *contents_;
  return c.vertices.capacity() * sizeof(Point) + c.edges.capacity() * sizeof(MeshEdge) +
         c.trapezoids.capacity() * sizeof(MeshTrapezoid) +
         c.lifespans.capacity() * sizeof(Lifespan) +
         c.feature_of.capacity() * sizeof(std::uint32_t) + c.index.memory() + c.features.memory();
}

}  // namespace trapeze
