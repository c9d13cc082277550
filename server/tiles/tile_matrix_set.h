// The tiles that maps are cut into, as the OGC describes them: tile matrix sets.
//
// Thread-safety: any thread; sets are immutable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "server/tiles/map_system.h"

namespace trapeze {

/// The tiles of a scale.
struct TileMatrix {
  std::string id;
  double cell_size = 0;  // of a pixel, in units of the reference system
  double scale_denominator = 0;
  // The corner that rows and columns are counted from: rows southwards from the north-west, or
  // northwards from the south-west.
  double west = 0;
  double origin_y = 0;
  bool is_from_south = false;
  int tile_width = kTilePixels;  // pixels
  int tile_height = kTilePixels;
  std::uint32_t width = 1;  // tiles
  std::uint32_t height = 1;

  /// The zoom of Web Mercator at which pixels are as large.
  double zoom() const;
};

/// The tiles of a matrix that a box touches, first and last.
struct TileLimits {
  std::uint32_t min_row = 0;
  std::uint32_t max_row = 0;
  std::uint32_t min_column = 0;
  std::uint32_t max_column = 0;
};

/// Of a tile, z counts the matrices.
struct TileMatrixSet {
  std::string id;
  std::string title;
  std::string uri;
  std::string scale_set;  // well-known, as a URI; may be empty
  MapSystemPtr system;
  std::vector<TileMatrix> matrices;  // from coarse to fine

  const TileMatrix* find(std::string_view id_of_matrix) const;
  /// Whether rows are counted from the north in all of them.
  bool is_from_north() const;
  bool has(const TileId& tile) const;
  /// Of a tile that it has; the picture has `scale` times as many pixels along each side.
  View view_of(const TileId& tile, int scale) const;
  /// The tiles that a box and so many pixels around it touch, or all if it is empty.
  TileLimits limits_of(const Box& box, std::size_t matrix, double pixels = 0) const;
};

using TileMatrixSetPtr = std::shared_ptr<const TileMatrixSet>;

const TileMatrixSetPtr& web_mercator_quad();
const TileMatrixSetPtr& world_crs84_quad();

/// Those that a server knows.
class TileMatrixSets {
 public:
  /// WebMercatorQuad, WorldCRS84Quad, EuropeanETRS89_LAEAQuad, UPSArcticWGS84Quad and
  /// UPSAntarcticWGS84Quad; those whose system PROJ does not know are left out.
  static const TileMatrixSets& built_in();

  /// Throws std::runtime_error if there is another of that id.
  void add(TileMatrixSetPtr set);

  /// Null if there is none of that id, in any case of letters.
  TileMatrixSetPtr find(std::string_view id) const;
  /// Those that have tiles of the layer, or of some layer.
  std::vector<TileMatrixSetPtr> of(const Dataset& dataset, std::string_view layer) const;
  std::vector<TileMatrixSetPtr> of(const Dataset& dataset) const;

 private:
  std::vector<TileMatrixSetPtr> sets_;
};

/// "WebMercatorQuad, WorldCRS84Quad".
std::string names_of(std::span<const TileMatrixSetPtr> sets);

}  // namespace trapeze
