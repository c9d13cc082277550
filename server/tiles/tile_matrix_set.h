// Tile matrix sets, as defined by the OGC: the tiles that maps are divided into.
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

constexpr double kMetresPerPixel = 0.00028;  // pixel size assumed by the OGC

/// The tiles of one scale.
struct TileMatrix {
  std::string id;
  double cell_size = 0;  // of a pixel, in units of the reference system
  double scale_denominator = 0;
  // The corner from which rows and columns are counted: rows run southwards from the north-west
  // corner, or northwards from the south-west corner.
  double west = 0;
  double origin_y = 0;
  bool is_from_south = false;
  int tile_width = kTilePixels;  // pixels
  int tile_height = kTilePixels;
  std::uint32_t width = 1;  // tiles
  std::uint32_t height = 1;

  /// The zoom of Web Mercator at which pixels have the same size.
  double zoom() const;
};

/// The tiles of a matrix that a box touches, first and last.
struct TileLimits {
  std::uint32_t min_row = 0;
  std::uint32_t max_row = 0;
  std::uint32_t min_column = 0;
  std::uint32_t max_column = 0;
};

/// The z of a tile is the index of its matrix.
struct TileMatrixSet {
  std::string id;
  std::string title;
  std::string uri;
  std::string scale_set;  // the URI of a well-known scale set; may be empty
  MapSystemPtr system;
  std::vector<TileMatrix> matrices;  // from coarse to fine

  const TileMatrix* find(std::string_view id_of_matrix) const;
  /// Whether all matrices count rows from the north.
  bool is_from_north() const;
  bool has(const TileId& tile) const;
  /// The view of a tile of this set; the picture has `scale` times as many pixels along each side.
  View view_of(const TileId& tile, int scale) const;
  /// The tiles touched by a box and a margin of that many pixels around it; all tiles if the box is
  /// empty.
  TileLimits limits_of(const Box& box, std::size_t matrix, double pixels = 0) const;
};

using TileMatrixSetPtr = std::shared_ptr<const TileMatrixSet>;

const TileMatrixSetPtr& web_mercator_quad();
const TileMatrixSetPtr& world_crs84_quad();

/// The sets that a server knows.
class TileMatrixSets {
 public:
  /// WebMercatorQuad, WorldCRS84Quad, EuropeanETRS89_LAEAQuad, UPSArcticWGS84Quad and
  /// UPSAntarcticWGS84Quad, without those whose reference system PROJ does not know.
  static const TileMatrixSets& built_in();

  /// Throws std::runtime_error if there already is a set with that id.
  void add(TileMatrixSetPtr set);

  /// Finds a set by its id, ignoring case; null if there is none.
  TileMatrixSetPtr find(std::string_view id) const;
  /// The sets with tiles of the layer, or of any layer.
  std::vector<TileMatrixSetPtr> of(const Dataset& dataset, std::string_view layer) const;
  std::vector<TileMatrixSetPtr> of(const Dataset& dataset) const;

 private:
  std::vector<TileMatrixSetPtr> sets_;
};

/// "WebMercatorQuad, WorldCRS84Quad".
std::string names_of(std::span<const TileMatrixSetPtr> sets);

}  // namespace trapeze
