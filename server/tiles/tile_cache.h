// An in-memory cache of drawn tiles, with a budget in bytes.
//
// The eviction policy is S3-FIFO (Yang et al., "FIFO queues are all you need for cache eviction",
// SOSP 2023). Tiles that are not requested again leave through a small queue, so a scan over a
// whole map does not evict popular tiles. The keys of tiles evicted that way are remembered for a
// while; if one is requested again, it goes directly to the main queue.
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
  /// `budget` is in bytes and covers tiles, their keys and the bookkeeping; 0: nothing is cached.
  explicit TileCache(std::size_t budget);
  ~TileCache();
  TileCache(const TileCache&) = delete;
  TileCache& operator=(const TileCache&) = delete;

  struct Tile {
    std::shared_ptr<const std::string> bytes;  // PNG or WebP
    TileHint hint = TileHint::none;
  };

  /// Returns null bytes if the tile is not cached.
  Tile find(std::string_view key);
  /// Caches the tile, unless it is too large for one shard's share of the budget.
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
  static constexpr std::size_t kShards = 16;  // so that threads rarely wait for each other

  Shard& shard_of(std::uint64_t hash) const;

  std::array<std::unique_ptr<Shard>, kShards> shards_;
};

}  // namespace trapeze
