// Input and result of painting a tile, for code that requests tiles and need not know how they are
// painted.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/grid/cancellation.h"
#include "render/picture/picture.h"

namespace trapeze {

struct TilePlan;

/// Version of the pictures of tiles. Raise it whenever the bytes of any tile change while
/// everything else in its fingerprint stays the same.
constexpr int kPictureVersion = 3;

/// Milliseconds spent in each step. Time shared by tiles that are drawn together is split evenly.
struct PaintTimes {
  double queue_ms = 0;  // until a worker started
  double select_ms = 0;
  double draw_ms = 0;
  double read_ms = 0;
  double resolve_ms = 0;
  double compose_ms = 0;
  double encode_ms = 0;
};

/// What a tile shows, in brief.
enum class TileHint : std::uint8_t {
  none,
  empty,  // only the background
  full,   // one colour, of polygons that cover the whole tile
};

struct PaintedTile {
  std::string fingerprint;                   // see TilePainter::paint()
  std::shared_ptr<const std::string> bytes;  // PNG or WebP; null if the tile was not wanted
  TileHint hint = TileHint::none;
  PaintTimes times;
  bool has_palette = true;  // as PNG, or would have one
};

/// A part of a tile: some of its rows, over the full width.
struct PaintedBand {
  RunPicture picture;
  TileHint hint = TileHint::none;
  PaintTimes times;
};

/// A tile to paint.
struct PaintJob {
  const TilePlan* plan = nullptr;
  const Cancellation* cancellation = nullptr;  // null: cannot be cancelled
  /// Whether the tile has to be painted, given its fingerprint. Empty: always.
  std::function<bool(const std::string& fingerprint)> is_wanted = {};
};

}  // namespace trapeze
