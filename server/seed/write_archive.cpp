#include "server/seed/write_archive.h"

#include "server/seed/mbtiles_writer.h"
#include "server/seed/pmtiles_writer.h"
#include "server/seed/tile_folder.h"

namespace trapeze {

std::unique_ptr<ArchiveWriter> write_archive(const std::string& path,
                                             const ArchiveDescription& description,
                                             const ArchiveSize& size) {
  switch (kind_of_archive(path)) {
    case ArchiveKind::pmtiles:
      return std::make_unique<PmtilesWriter>(path, description, size);
    case ArchiveKind::mbtiles:
      return std::make_unique<MbtilesWriter>(path, description, size);
    case ArchiveKind::folder:
      break;
  }
  return std::make_unique<TileFolder>(path, description, size);
}

}  // namespace trapeze
