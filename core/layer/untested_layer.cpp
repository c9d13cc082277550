#include "core/layer/untested_layer.h"

#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"
#include "core/layer/layer_contents.h"

namespace trapeze {

namespace {

std::unique_ptr<const Layer> build_without_test(const Layer& layer) {
  LayerOptions options = layer.contents().options;
  options.topology = Topology::fast;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  Rings rings;
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    rings.clear();
    layer.append_outline(row, rings);
    builders.front().add(row, rings);
  }
  return LayerBuilder::join(builders, FeatureTable());
}

}  // namespace

const Layer& UntestedLayer::get() const {
  if (layer_.contents().options.topology == Topology::fast) return layer_;
  std::call_once(once_, [this] {
    built_ = build_without_test(layer_);
    is_built_ = true;
  });
  return *built_;
}

std::optional<std::uint64_t> UntestedLayer::mesh_id() const {
  return is_built_ ? std::optional(built_->mesh().id) : std::nullopt;
}

std::size_t UntestedLayer::memory() const {
  return is_built_ ? built_->memory() : 0;
}

}  // namespace trapeze
