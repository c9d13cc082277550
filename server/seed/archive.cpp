#include "server/seed/archive.h"

#include <filesystem>

#include "server/base/nearest_name.h"

namespace trapeze {

void ArchiveWriter::add_fingerprint(const Digest& /*fingerprint*/, const Digest& /*content*/) {}

ArchiveKind kind_of_archive(const std::string& path) {
  const std::string ending = in_lower_case(std::filesystem::path(path).extension().string());
  if (ending == ".pmtiles") return ArchiveKind::pmtiles;
  return ending == ".mbtiles" ? ArchiveKind::mbtiles : ArchiveKind::folder;
}

}  // namespace trapeze
