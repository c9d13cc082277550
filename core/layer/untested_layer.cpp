#include "core/layer/untested_layer.h"

#include <vector>

#include "core/layer/layer_builder.h"
#include "core/layer/layer_contents.h"

namespace trapeze {

std::unique_ptr<const Layer> build_without_topology_test(const Layer& layer) {
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

}  // namespace trapeze
