// Finds the tiles that differ between two states of the data.
//
// Thread-safety: any thread; the work is done on all cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid/name_table.h"
#include "core/grid/web_mercator.h"
#include "server/base/result.h"
#include "server/base/zoom_range.h"
#include "server/data/dataset.h"
#include "server/labels/label_book.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

/// How certain it is that a listed tile has changed.
enum class Certainty : std::uint8_t {
  candidates,    // may have changed, in any style with the simplify of the requested one that does
                 // not reach farther
  fingerprints,  // the data it is drawn from has changed
  bytes,         // its bytes have changed, as found by drawing it
};

inline constexpr NameTable<Certainty, 3> kCertaintyNames({
    {"bytes", Certainty::bytes},
    {"candidates", Certainty::candidates},
    {"fingerprints", Certainty::fingerprints},
});

struct ChangeRequest {
  /// The tile id in it is ignored. Its layers must exist in both states, and all of them are
  /// compared.
  TileRequest tile;
  ZoomRange zooms;
  /// Tiles of all scales from that of `tile` up to this one count, if it is greater: those of a
  /// larger scale show smaller changes. Only with Certainty::candidates.
  int most_scale = 1;
  Certainty certainty = Certainty::fingerprints;
  /// For one zoom: if more tiles changed, none is listed from that zoom on.
  std::size_t most_tiles = 1'000'000;
  /// Places and draws the labels of the style. Without fonts, none are drawn.
  std::shared_ptr<LabelBook> labels = std::make_shared<LabelBook>();
};

struct ChangedTiles {
  std::vector<TileId> tiles;  // by zoom, row and column
  /// The zooms examined: fewer than requested if too many tiles have changed.
  ZoomRange zooms;
  bool is_complete = true;  // covers all requested zooms
};

/// All tiles of these zooms that differ between the two states; none is missing. The problem is
/// that of plan_tile().
Result<ChangedTiles> changed_tiles(const ChangeRequest& request,
                                   const std::shared_ptr<const Dataset>& before,
                                   const std::shared_ptr<const Dataset>& after);

}  // namespace trapeze
