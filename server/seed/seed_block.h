// The tiles of one job as they are kept until the archive is made: which tile has which content,
// and the contents, each once. A block is one piece of memory, as it lies in a file.
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

/// How tiles became known.
struct SeedFigures {
  std::uint64_t drawn = 0;  // by a renderer, or found among those of an earlier archive
  std::uint64_t alone = 0;  // looked at one by one, and found to be of one colour
  std::uint64_t known = 0;  // with all that lie below a tile

  std::uint64_t tiles() const { return drawn + alone + known; }
  void add(const SeedFigures& more) {
    drawn += more.drawn;
    alone += more.alone;
    known += more.known;
  }
};

/// Of a tile's bytes. Those of equal bytes are equal.
Digest digest_of_bytes(std::string_view bytes);

// The parts of a block, as they are stored.
struct BlockContent {
  Digest digest;
  std::uint64_t offset = 0;  // in the data of the block
  std::uint32_t length = 0;
  std::uint32_t is_empty = 0;  // 1 if nothing is seen in it
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
  std::uint64_t bytes = 0;     // of the whole block, this header among them; a multiple of 8
  std::uint64_t checksum = 0;  // of all that follows here
  std::uint64_t job = 0;
  SeedFigures figures;
  std::uint64_t contents = 0;
  std::uint64_t fingerprints = 0;
  std::array<std::uint64_t, kMaxZoom + 1> entries = {};  // by zoom
};

/// Thread-safety: one thread at a time.
class SeedBlockBuilder {
 public:
  /// The content of a tile of that fingerprint, if it is there already.
  std::optional<std::uint64_t> find(const Digest& fingerprint) const;
  /// The number of a content, which is added unless there is one of equal bytes.
  std::uint64_t add_content(std::string_view bytes, bool is_empty);
  void add_fingerprint(const Digest& fingerprint, std::uint64_t content);
  /// After all others of that zoom, in order.
  void add_tiles(int zoom, const PlaceRange& places, std::uint64_t content);

  SeedFigures figures;

  /// The block.
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
  /// The block that `bytes` begins with. Nothing if there is none, or it is not whole.
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
