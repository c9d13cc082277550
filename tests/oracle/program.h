// Pictures as the server answers with them, without a socket, drawn in plain C++.
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
  /// Serves the files as layers of their names, drawn in that map.
  Program(const std::vector<std::string>& files, CoverageMode coverage, Map map = Map::mercator);
  /// Built for a reference system besides.
  Program(const std::vector<std::string>& files, const std::string& system);

  /// Of layers, the lowest one first; empty, with a failure of the test, if there is none.
  Picture tile(const std::vector<std::string>& layers, TileName name, const std::string& query);
  /// What stands between "/map/" and the style: "malta.png?crs=EPSG:4326&bbox=...".
  Picture map(const std::string& target, const std::string& query);

 private:
  Picture picture(const std::string& target);

  testing::SampleSite site_{false};
  Map map_ = Map::mercator;
};

std::string text_of(TileName name);
/// As URLs have it. In degrees zoom is at least 2, and the tile between the poles.
std::string path_of(TileName name, Map map);

}  // namespace trapeze::oracle
