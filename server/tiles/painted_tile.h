// What painting a tile takes and gives, for those who ask for tiles and need not know how it is
// done.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/grid/cancellation.h"
#include "render/picture/picture.h"

namespace trapeze {

struct TilePlan;

/// Of the pictures of tiles: raised whenever the bytes of any tile become others although it is
/// drawn from the same, so that nothing else of its fingerprint changes.
constexpr int kPictureVersion = 2;

/// Milliseconds that each step took. What tiles that are drawn together share is shared out evenly.
struct PaintTimes {
  double queue_ms = 0;  // until a worker began
  double select_ms = 0;
  double draw_ms = 0;
  double read_ms = 0;
  double resolve_ms = 0;
  double compose_ms = 0;
  double encode_ms = 0;
};

/// What a tile shows, at a glance.
enum class TileHint : std::uint8_t {
  none,
  empty,  // nothing but the background
  full,   // one colour, of polygons that cover it wholly
};

struct PaintedTile {
  std::string fingerprint;                   // see TilePainter::paint()
  std::shared_ptr<const std::string> bytes;  // PNG or WebP; null if it was not wanted
  TileHint hint = TileHint::none;
  PaintTimes times;
  bool has_palette = true;  // or would have one, as PNG
};

/// A part of a tile: some of its rows, over its whole width.
struct PaintedBand {
  RunPicture picture;
  TileHint hint = TileHint::none;
  PaintTimes times;
};

/// A tile to paint.
struct PaintJob {
  const TilePlan* plan = nullptr;
  const Cancellation* cancellation = nullptr;  // null: wanted whatever happens
  /// Whether a tile of that fingerprint has to be painted. Empty: it has.
  std::function<bool(const std::string& fingerprint)> is_wanted = {};
};

}  // namespace trapeze
