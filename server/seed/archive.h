// Writing archives of tiles: tile by tile, in order of zoom, and within a zoom along the Hilbert
// curve.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/grid/digest.h"
#include "core/grid/name_table.h"
#include "server/base/zoom_range.h"
#include "server/data/layer_summary.h"
#include "server/seed/hilbert_order.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

/// Longitude and latitude in degrees.
using GeographicCenter = std::array<double, 2>;

/// The metadata of an archive.
struct ArchiveDescription {
  std::string name;
  std::string description;
  std::string attribution;
  ZoomRange zooms;
  GeographicBounds bounds = kWorldBounds;
  GeographicCenter center = {0, 0};
  TileFormat format = TileFormat::png;
  int scale = 1;
  std::string layers;  // comma-separated
  std::string style;   // as a query

  friend bool operator==(const ArchiveDescription&, const ArchiveDescription&) = default;
};

enum class ArchiveKind : std::uint8_t { pmtiles, mbtiles, folder };

/// Determined by the file name extension; names without one of the two mean a folder.
ArchiveKind kind_of_archive(const std::string& path);

/// Upper bounds.
struct ArchiveSize {
  std::uint64_t entries = 0;
  std::uint64_t contents = 0;
  std::uint64_t fingerprints = 0;
};

/// Tiles with the same content.
struct ArchiveTiles {
  int zoom = 0;
  PlaceRange places;
  Digest digest;  // of the bytes
  std::string_view bytes;
};

/// Nothing exists under the archive's name until it is finished. All methods throw
/// std::runtime_error that names the archive and says why it cannot be written. One thread at a
/// time.
class ArchiveWriter {
 public:
  virtual ~ArchiveWriter() = default;

  virtual void add(const ArchiveTiles& tiles) = 0;
  /// The fingerprint of a content that was added; the same one may be added again.
  virtual void add_fingerprint(const Digest& fingerprint, const Digest& content);
  virtual void finish() = 0;
};

}  // namespace trapeze
