// Archives of tiles, as they are written: one tile after another, by zoom, and within a zoom along
// the curve.
#pragma once

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

/// What an archive says of itself.
struct ArchiveDescription {
  std::string name;
  std::string description;
  std::string attribution;
  ZoomRange zooms;
  GeographicBounds bounds = kWorldBounds;
  TileFormat format = TileFormat::png;
  int scale = 1;
  std::string layers;  // with commas between them
  std::string style;   // as a query
};

enum class ArchiveKind : std::uint8_t { pmtiles, mbtiles, folder };

/// The ends of names; a folder is what has neither.
ArchiveKind kind_of_archive(const std::string& path);

/// Upper bounds.
struct ArchiveSize {
  std::uint64_t entries = 0;
  std::uint64_t contents = 0;
  std::uint64_t fingerprints = 0;
};

/// Tiles of one content.
struct ArchiveTiles {
  int zoom = 0;
  PlaceRange places;
  Digest digest;  // of the bytes
  std::string_view bytes;
};

/// Nothing has the name of the archive until it is finished. All methods throw std::runtime_error
/// that names the archive and says why it cannot be written. One thread at a time.
class ArchiveWriter {
 public:
  virtual ~ArchiveWriter() = default;

  virtual void add(const ArchiveTiles& tiles) = 0;
  /// Of a content that was added; equal ones may come again.
  virtual void add_fingerprint(const Digest& fingerprint, const Digest& content);
  virtual void finish() = 0;
};

}  // namespace trapeze
