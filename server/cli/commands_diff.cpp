#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "server/changes/changed_tiles.h"
#include "server/changes/tile_list.h"
#include "server/cli/commands.h"
#include "server/config/load_config.h"
#include "server/tiles/open_fonts.h"

namespace trapeze {
namespace {

// The layer's name in both states, whatever the files are called.
constexpr const char* kLayer = "layer";

std::shared_ptr<const Dataset> load(const std::string& file, const DiffArguments& arguments,
                                    bool fast_topology) {
  std::vector<LayerConfig> layers = layers_or_throw({file});
  layers.front().name = kLayer;
  layers.front().fast_topology = fast_topology;
  apply(arguments.coverage, layers.front());
  return Dataset::load(layers);
}

ChangeRequest make_request(const DiffArguments& arguments) {
  ChangeRequest request;
  request.tile.layers = {kLayer};
  request.tile.scale = arguments.scale;
  request.tile.style = style_or_throw(arguments.style, request.tile.layers);
  const auto zooms = parse_zooms(arguments.zooms);
  if (!zooms) {
    throw UsageError(
        fmt::format("--zooms takes a zoom or a range of them such as 0-12, from 0 to "
                    "{}, got \"{}\"",
                    kMaxZoom, arguments.zooms));
  }
  request.zooms = *zooms;
  request.certainty = word_or_throw("--certainty", arguments.certainty, kCertaintyNames);
  if (request.tile.style.value_for(kLayer, ParameterId::label)) {
    request.labels = std::make_shared<LabelBook>(FontChoice{open_fonts({})});
  }
  return request;
}

}  // namespace

int run_diff(const DiffArguments& arguments) {
  const TileListFormat format = word_or_throw("--format", arguments.format, kTileListNames);
  const ChangeRequest request = make_request(arguments);
  const auto topology = request.tile.style.value_for(kLayer, ParameterId::topology);
  const bool is_fast = topology && *topology == ParameterValue("fast");
  const auto before = load(arguments.before, arguments, is_fast);
  const auto after = load(arguments.after, arguments, is_fast);
  const auto found = changed_tiles(request, before, after);
  if (!found) throw_wrong_style(found.problem());
  fmt::print("{}", tile_list(found->tiles, format));
  if (found->is_complete) return 0;
  fmt::print(stderr,
             "trapeze: more than {} tiles of zoom {} may have changed: tiles of this and higher "
             "zooms are not listed\n",
             request.most_tiles, found->zooms.last + 1);
  return 1;
}

}  // namespace trapeze
