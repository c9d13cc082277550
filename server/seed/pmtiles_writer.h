// PMTiles, version 3: a single file, read with HTTP range requests.
//
// The header and the root directory come first, within 16 KiB, as the specification requires. Then
// follow the tiles, in order and without duplicate contents ("clustered"), the leaf directories,
// the metadata, and finally a section that only `trapeze seed --update` reads: the fingerprints by
// which tiles are recognised, with the positions of their bytes. The metadata contain the position
// of that section.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/grid/digest.h"
#include "core/io/file/atomic_file.h"
#include "server/seed/archive.h"
#include "server/seed/content_table.h"
#include "server/seed/scratch_array.h"

namespace trapeze {

/// The size of the header, as specified.
inline constexpr std::uint64_t kPmtilesHeaderBytes = 127;

/// An entry of a directory: `run` tiles from `id` on have these bytes. If run is 0, the entry
/// refers to a leaf directory.
struct PmtilesEntry {
  std::uint64_t id = 0;
  std::uint64_t offset = 0;
  std::uint32_t length = 0;
  std::uint32_t run = 0;
};

/// The stored form of fingerprints, which are sorted.
struct StoredFingerprint {
  Digest fingerprint;
  std::uint64_t offset = 0;  // in the file
  std::uint32_t length = 0;
  std::uint32_t check = 0;  // check_of() the digest of the bytes
};
/// What recognises damaged bytes.
inline std::uint32_t check_of(const Digest& content) {
  return static_cast<std::uint32_t>(content.low);
}

/// The member of the metadata that contains the position of the fingerprints.
inline constexpr const char* kPmtilesOwnMember = "trapeze";

class PmtilesWriter final : public ArchiveWriter {
 public:
  PmtilesWriter(const std::string& path, ArchiveDescription description, const ArchiveSize& size);

  void add(const ArchiveTiles& tiles) override;
  void add_fingerprint(const Digest& fingerprint, const Digest& content) override;
  void finish() override;

 private:
  struct Section {
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
  };
  struct Directories {
    std::string root;
    Section leaves;
  };

  void append(std::string_view bytes);
  void flush();
  void add_entries(std::uint64_t id, std::uint64_t count, const ContentTable::Content& content);
  Directories write_directories();
  Section write_fingerprints();
  std::string metadata(const Section& fingerprints) const;
  std::string header(const Directories& directories, const Section& metadata,
                     std::uint64_t end_of_data) const;

  const ArchiveDescription description_;
  AtomicFile file_;
  std::string buffer_;
  std::uint64_t end_ = 0;  // of the data written so far
  ContentTable contents_;
  ScratchArray<PmtilesEntry> entries_;
  ScratchArray<StoredFingerprint> fingerprints_;
  std::uint64_t entry_count_ = 0;
  std::uint64_t fingerprint_count_ = 0;
  std::uint64_t content_count_ = 0;
  std::uint64_t tile_count_ = 0;
};

}  // namespace trapeze
