// Tiles that were drawn, kept in memory within a budget of bytes.
//
// Which to keep is decided by S3-FIFO (Yang et al., "FIFO queues are all you need for cache
// eviction", SOSP 2023): a tile that nobody asks for again leaves through a small queue, so a scan
// over a whole map does not push out what is asked for often. The keys of tiles that left that way
// are remembered for a while; one that comes back goes to the main queue at once.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/tiles/painted_tile.h"

namespace trapeze {

class TileCache {
 public:
  /// `budget` bytes for tiles, their keys and what keeps them in order; 0: nothing is kept.
  explicit TileCache(std::size_t budget);
  ~TileCache();
  TileCache(const TileCache&) = delete;
  TileCache& operator=(const TileCache&) = delete;

  struct Tile {
    std::shared_ptr<const std::string> bytes;  // PNG or WebP
    TileHint hint = TileHint::none;
  };

  /// Its bytes are null if the tile is not there.
  Tile find(std::string_view key);
  /// Keeps the tile, if it is not larger than what a part of the budget can hold.
  void insert(std::string_view key, const Tile& tile);

  struct Figures {
    std::size_t bytes = 0;
    std::size_t tiles = 0;
    std::uint64_t hits = 0;
    std::uint64_t misses = 0;
  };
  Figures figures() const;

 private:
  class Shard;
  static constexpr std::size_t kShards = 16;  // so that threads seldom wait for each other

  Shard& shard_of(std::uint64_t hash) const;

  std::array<std::unique_ptr<Shard>, kShards> shards_;
};

}  // namespace trapeze
