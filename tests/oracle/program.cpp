#include "tests/oracle/program.h"

#include <gtest/gtest.h>

#include "render/picture/png.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"

namespace trapeze::oracle {

Program::Program(const std::vector<std::string>& files, CoverageMode coverage, Map map)
    : map_(map) {
  std::vector<LayerConfig> layers = layers_of_files(files);
  for (LayerConfig& layer : layers) layer.coverage = coverage;
  site_.data().set(Dataset::load(layers));
}

Program::Program(const std::vector<std::string>& files, const std::string& system) {
  std::vector<LayerConfig> layers = layers_of_files(files);
  for (LayerConfig& layer : layers) layer.crs = {"EPSG:3857", system};
  site_.data().set(Dataset::load(layers));
}

Picture Program::tile(const std::vector<std::string>& layers, TileName name,
                      const std::string& query) {
  std::string list;
  for (const std::string& layer : layers) list += (list.empty() ? "" : ",") + layer;
  return picture("/tiles/" + list + "/" + path_of(name, map_) + ".png?" + query);
}

Picture Program::map(const std::string& target, const std::string& query) {
  return picture("/map/" + target + "&" + query);
}

Picture Program::picture(const std::string& target) {
  const HttpResponse response = site_.get(target);
  EXPECT_EQ(response.status, 200) << target << (response.body ? *response.body : "");
  return response.status == 200 ? decode_png(*response.body) : Picture();
}

std::string text_of(TileName name) {
  return std::to_string(name.zoom) + "/" + std::to_string(name.x) + "/" + std::to_string(name.y);
}

std::string path_of(TileName name, Map map) {
  if (map == Map::mercator) return text_of(name);
  // A quarter of the rows of the square lies beyond each pole.
  return "WorldCRS84Quad/" + text_of({name.zoom - 1, name.x, name.y - (1u << (name.zoom - 2))});
}

}  // namespace trapeze::oracle
