// An archive that was seeded before, for what has not changed since.
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
  /// Throws std::runtime_error that names the path if it is no archive in PMTiles that
  /// `trapeze seed` has written.
  explicit EarlierArchive(const std::string& path);

  /// The bytes of a tile of that fingerprint, if there is one.
  std::optional<std::string> find(const Digest& fingerprint) const;

 private:
  MappedFile file_;
  std::span<const StoredFingerprint> fingerprints_;
};

}  // namespace trapeze
