// Which tiles show something else in one state of the data than in another.
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
#include "server/tiles/tile_request.h"

namespace trapeze {

/// How sure it is that a tile that is listed has changed.
enum class Certainty : std::uint8_t {
  candidates,    // it may have, in any style that simplifies as the one that is asked for
  fingerprints,  // what it is drawn from has
  bytes,         // its bytes have: it was drawn
};

inline constexpr NameTable<Certainty, 3> kCertaintyNames({
    {"bytes", Certainty::bytes},
    {"candidates", Certainty::candidates},
    {"fingerprints", Certainty::fingerprints},
});

struct ChangeRequest {
  /// Of which the tile is not looked at. Its layers are in both states, and all of them are
  /// compared.
  TileRequest tile;
  ZoomRange zooms;
  Certainty certainty = Certainty::fingerprints;
  /// Of one zoom: from there on none is listed.
  std::size_t most_tiles = 1'000'000;
};

struct ChangedTiles {
  std::vector<TileId> tiles;  // by zoom, row and column
  /// The zooms that were looked at: fewer than were asked for where too many tiles have changed.
  ZoomRange zooms;
  bool is_complete = true;  // all zooms that were asked for
};

/// The tiles of these zooms that differ between the two states: none is left out. The problem is
/// that of plan_tile().
Result<ChangedTiles> changed_tiles(const ChangeRequest& request,
                                   const std::shared_ptr<const Dataset>& before,
                                   const std::shared_ptr<const Dataset>& after);

}  // namespace trapeze
