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
  /// Serves the files as layers of their names.
  Program(const std::vector<std::string>& files, CoverageMode coverage);

  /// Of layers, the lowest one first; empty, with a failure of the test, if there is none.
  Picture tile(const std::vector<std::string>& layers, TileName name, const std::string& query);

 private:
  testing::SampleSite site_{false};
};

std::string text_of(TileName name);

}  // namespace trapeze::oracle
