// The tiles of one job as they are stored until the archive is created: the content of each tile,
// and the contents without duplicates. A block is a contiguous piece of memory, with the same
// layout as in the file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/digest.h"
#include "core/grid/web_mercator.h"
#include "server/seed/hilbert_order.h"

namespace trapeze {

/// Counts of tiles by how their contents were determined.
struct SeedFigures {
  std::uint64_t drawn = 0;  // by a renderer, or taken from an earlier archive
  std::uint64_t alone = 0;  // examined individually, and of one colour
  std::uint64_t known = 0;  // together with all tiles below a tile

  std::uint64_t tiles() const { return drawn + alone + known; }
  void add(const SeedFigures& more) {
    drawn += more.drawn;
    alone += more.alone;
    known += more.known;
  }
};

/// The digest of a tile's bytes.
Digest digest_of_bytes(std::string_view bytes);

/// Blocks begin in a log at multiples of it, and their sizes are multiples of it.
constexpr std::size_t kBlockAlignment = 8;

// The parts of a block, in their stored layout.
struct BlockContent {
  Digest digest;
  std::uint64_t offset = 0;  // in the data of the block
  std::uint32_t length = 0;
  std::uint32_t is_empty = 0;  // 1 if it shows nothing
};
struct BlockEntry {
  PlaceRange places;
  std::uint64_t content = 0;
};
struct BlockFingerprint {
  Digest fingerprint;  // see TilePainter
  std::uint64_t content = 0;
};
struct BlockHeader {
  std::uint64_t mark = 0;
  std::uint64_t bytes = 0;     // of the whole block including this header and its padding
  std::uint64_t checksum = 0;  // of everything that follows
  std::uint64_t job = 0;
  SeedFigures figures;
  std::uint64_t contents = 0;
  std::uint64_t fingerprints = 0;
  std::array<std::uint64_t, kMaxZoom + 1> entries = {};  // by zoom
};

/// Thread-safety: one thread at a time.
class SeedBlockBuilder {
 public:
  /// The content of a tile with that fingerprint, if it has already been added.
  std::optional<std::uint64_t> find(const Digest& fingerprint) const;
  /// The number of a content; adds it unless one with equal bytes exists.
  std::uint64_t add_content(std::string_view bytes, bool is_empty);
  void add_fingerprint(const Digest& fingerprint, std::uint64_t content);
  /// Must be called in order, after all other tiles of that zoom.
  void add_tiles(int zoom, const PlaceRange& places, std::uint64_t content);

  SeedFigures figures;

  /// The finished block.
  std::vector<std::byte> bytes(std::uint64_t job) const;

 private:
  std::array<std::vector<BlockEntry>, kMaxZoom + 1> entries_;  // by zoom
  std::vector<BlockContent> contents_;
  std::map<Digest, std::uint64_t> by_digest_;
  std::map<Digest, std::uint64_t> by_fingerprint_;
  std::string data_;
};

/// A view of a block in memory, which must outlive it.
class SeedBlock {
 public:
  /// The block at the beginning of `bytes`; nothing if there is none, or it is incomplete or
  /// damaged.
  static std::optional<SeedBlock> read(std::span<const std::byte> bytes);

  std::uint64_t job() const { return header_.job; }
  const SeedFigures& figures() const { return header_.figures; }
  std::size_t size() const { return header_.bytes; }

  std::span<const BlockEntry> entries(int zoom) const;
  std::span<const BlockContent> contents() const { return contents_; }
  std::span<const BlockFingerprint> fingerprints() const { return fingerprints_; }
  std::string_view bytes_of(const BlockContent& content) const {
    return data_.substr(content.offset, content.length);
  }

 private:
  BlockHeader header_;
  std::span<const BlockContent> contents_;
  std::span<const BlockFingerprint> fingerprints_;
  std::span<const BlockEntry> entries_;  // of all zooms
  std::string_view data_;
};

}  // namespace trapeze
