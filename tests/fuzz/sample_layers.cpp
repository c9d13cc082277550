#include "tests/fuzz/sample_layers.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"

namespace trapeze::fuzzing {
namespace {

ServedLayer served(LayerConfig config, std::vector<LayerBuilder> builders, FeatureTable features) {
  ServedLayer layer;
  layer.config = std::move(config);
  layer.config.title = layer.config.name;
  layer.layer = LayerBuilder::join(builders, std::move(features));
  layer.revision = revision_of(*layer.layer);
  return layer;
}

ServedLayer land() {
  LayerConfig config;
  config.name = "land";
  config.attribution = "drawn <by> \"hand\"";
  FeatureTable features(
      {{"name", FieldType::text}, {"rank", FieldType::integer}, {"size", FieldType::real}});
  std::vector<LayerBuilder> builders(1);
  for (std::int32_t i = 0; i < 12; ++i) {
    const std::int32_t side = 200 << (2 * i - (i > 10 ? 1 : 0));
    Rings rings;
    rings.add(
        std::vector<Point>{{0, 0}, {side, i}, {side, side}, {side / 2, side / 3}, {-i, side}});
    if (i % 4 == 3) rings.add(std::vector<Point>{{9, 9}, {side / 4, 40}, {50, side / 4}});
    const std::string name = i == 5 ? "O'Hara, \"Köln\"" : "name " + std::to_string(i % 5);
    const std::vector<Value> values = {std::string_view(name),
                                       i % 3 == 0 ? Value() : Value(std::int64_t{i}), i * 1.5};
    builders[0].add(features.append(i, values), rings);
  }
  return served(std::move(config), std::move(builders), std::move(features));
}

ServedLayer water() {
  LayerConfig config;
  config.name = "water";
  config.min_zoom = 1;
  config.max_zoom = 6;
  config.locked = {ParameterId::stroke};
  FeatureTable features;
  std::vector<LayerBuilder> builders(1);
  for (const std::int32_t place : {-300'000'000, 100'000'000}) {
    Rings rings;
    rings.add(std::vector<Point>{
        {place, place}, {place + 200'000'000, place}, {place + 200'000'000, place + 150'000'000}});
    builders[0].add(features.append(place, {}), rings);
  }
  return served(std::move(config), std::move(builders), std::move(features));
}

}  // namespace

std::shared_ptr<const Dataset> sample_layers() {
  std::vector<ServedLayer> layers;
  layers.push_back(land());
  layers.push_back(water());
  return std::make_shared<const Dataset>(std::move(layers));
}

}  // namespace trapeze::fuzzing
