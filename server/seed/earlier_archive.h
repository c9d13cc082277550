// An archive seeded earlier, from which unchanged tiles are reused.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/grid/digest.h"
#include "core/io/file/mapped_file.h"
#include "server/seed/pmtiles_writer.h"

namespace trapeze {

/// Thread-safety: immutable, any number of threads may read.
class EarlierArchive {
 public:
  /// Throws std::runtime_error that names the path if it is not a PMTiles archive written by
  /// `trapeze seed`.
  explicit EarlierArchive(const std::string& path);

  /// The bytes of a tile with that fingerprint, if there is one that is not damaged.
  std::optional<std::string> find(const Digest& fingerprint) const;

 private:
  MappedFile file_;
  std::span<const StoredFingerprint> fingerprints_;
};

}  // namespace trapeze
