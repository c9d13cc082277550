// Pictures as the server returns them, without a socket, rendered in plain C++.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/layer/layer_options.h"
#include "render/picture/compose.h"
#include "tests/oracle/true_tile.h"
#include "tests/server/service/sample_site.h"

namespace trapeze::oracle {

class Program {
 public:
  /// Serves the files as layers named after them, in that map.
  Program(const std::vector<std::string>& files, CoverageMode coverage, Map map = Map::mercator);
  /// Also built for a reference system.
  Program(const std::vector<std::string>& files, const std::string& system);

  /// The layers are given with the lowest one first. Returns an empty picture, and fails the test,
  /// if there is none.
  Picture tile(const std::vector<std::string>& layers, TileName name, const std::string& query);
  /// `target` is the part between "/map/" and the style: "malta.png?crs=EPSG:4326&bbox=...".
  Picture map(const std::string& target, const std::string& query);

 private:
  Picture picture(const std::string& target);

  testing::SampleSite site_{false};
  Map map_ = Map::mercator;
};

std::string text_of(TileName name);
/// The path in URLs. In degrees, zoom is at least 2 and the tile lies between the poles.
std::string path_of(TileName name, Map map);

}  // namespace trapeze::oracle
