#include "server/tiles/tile_cache.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <iterator>
#include <list>
#include <mutex>
#include <unordered_map>
#include <unordered_set>

namespace trapeze {
namespace {

// Cost of an entry besides its key and picture: nodes of list and map, and the allocator.
constexpr std::size_t kOverhead = 256;
constexpr std::size_t kSmallShare = 10;  // the small queue gets 1/kSmallShare of the budget
constexpr std::uint8_t kMostHits = 3;    // counted per entry

std::uint64_t hash_of(std::string_view key) {
  return std::hash<std::string_view>()(key);
}

}  // namespace

class TileCache::Shard {
 public:
  explicit Shard(std::size_t budget) : budget_(budget) {}

  Tile find(std::string_view key) {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) {
      ++misses_;
      return {};
    }
    ++hits_;
    Entry& entry = *found->second;
    entry.hits = std::min<std::uint8_t>(static_cast<std::uint8_t>(entry.hits + 1), kMostHits);
    return entry.tile;
  }

  void insert(std::string_view key, std::uint64_t hash, const Tile& tile) {
    const std::size_t bytes = kOverhead + 2 * key.size() + tile.bytes->size();
    const std::lock_guard lock(mutex_);
    if (bytes > budget_ || entries_.contains(key)) return;
    while (bytes_ + bytes > budget_) evict();
    const bool is_back = ghosts_.contains(hash);
    Queue& queue = is_back ? main_ : small_;
    queue.push_back({std::string(key), hash, tile, bytes, 0});
    try {
      entries_.emplace(queue.back().key, std::prev(queue.end()));
    } catch (...) {
      queue.pop_back();  // otherwise its bytes, which are not counted yet, would be subtracted
      throw;
    }
    bytes_ += bytes;
    if (!is_back) small_bytes_ += bytes;
  }

  void add_to(Figures& figures) const {
    const std::lock_guard lock(mutex_);
    figures.bytes += bytes_;
    figures.tiles += entries_.size();
    figures.hits += hits_;
    figures.misses += misses_;
  }

 private:
  struct Entry {
    std::string key;
    std::uint64_t hash = 0;
    Tile tile;
    std::size_t bytes = 0;
    std::uint8_t hits = 0;  // since it entered its queue, or was last spared
  };
  using Queue = std::list<Entry>;

  void evict() {
    if (small_bytes_ > budget_ / kSmallShare || main_.empty()) {
      evict_from_small();
    } else {
      evict_from_main();
    }
  }

  // Evicts the entry, or moves it to the main queue if it was requested.
  void evict_from_small() {
    Entry& oldest = small_.front();
    if (oldest.hits > 0) {
      small_bytes_ -= oldest.bytes;
      oldest.hits = 0;
      main_.splice(main_.end(), small_, small_.begin());
      return;
    }
    remember(oldest.hash);  // first, as memory may run out
    small_bytes_ -= oldest.bytes;
    drop(small_);
  }

  // Evicts the entry, or moves it to the back if it was requested.
  void evict_from_main() {
    Entry& oldest = main_.front();
    if (oldest.hits > 0) {
      --oldest.hits;
      main_.splice(main_.end(), main_, main_.begin());
      return;
    }
    drop(main_);
  }

  void drop(Queue& queue) {
    bytes_ -= queue.front().bytes;
    entries_.erase(queue.front().key);
    queue.pop_front();
  }

  void remember(std::uint64_t hash) {
    if (ghosts_.contains(hash)) return;
    ghost_queue_.push_back(hash);
    ghosts_.insert(hash);
    while (ghost_queue_.size() > std::max<std::size_t>(entries_.size(), 16)) {
      ghosts_.erase(ghost_queue_.front());
      ghost_queue_.pop_front();
    }
  }

  const std::size_t budget_;
  mutable std::mutex mutex_;  // guards everything below
  Queue small_;
  Queue main_;
  std::unordered_map<std::string_view, Queue::iterator> entries_;  // keys point into the entries
  std::unordered_set<std::uint64_t> ghosts_;
  std::deque<std::uint64_t> ghost_queue_;
  std::size_t bytes_ = 0;
  std::size_t small_bytes_ = 0;
  std::uint64_t hits_ = 0;
  std::uint64_t misses_ = 0;
};

TileCache::TileCache(std::size_t budget) {
  for (auto& shard : shards_) shard = std::make_unique<Shard>(budget / kShards);
}

TileCache::~TileCache() = default;

TileCache::Tile TileCache::find(std::string_view key) {
  return shard_of(hash_of(key)).find(key);
}

void TileCache::insert(std::string_view key, const Tile& tile) {
  const std::uint64_t hash = hash_of(key);
  shard_of(hash).insert(key, hash, tile);
}

TileCache::Shard& TileCache::shard_of(std::uint64_t hash) const {
  return *shards_[(hash >> 32) % kShards];
}

TileCache::Figures TileCache::figures() const {
  Figures figures;
  for (const auto& shard : shards_) shard->add_to(figures);
  return figures;
}

}  // namespace trapeze
