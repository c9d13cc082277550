#include "server/seed/seed_block.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "core/io/file/checksum.h"
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace trapeze {
namespace {

constexpr std::uint64_t kBlockMark = 0x31636f6c62656573;  // "seebloc1"

template <typename T>
void append(std::span<const T> items, std::vector<std::byte>& bytes) {
  const auto raw = std::as_bytes(items);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// Removes `count` items from the beginning of `bytes`; nothing if there are fewer.
template <typename T>
std::optional<std::span<const T>> take(std::span<const std::byte>& bytes, std::uint64_t count) {
  if (count > bytes.size() / sizeof(T)) return std::nullopt;
  const std::span<const T> items(reinterpret_cast<const T*>(bytes.data()), count);
  bytes = bytes.subspan(count * sizeof(T));
  return items;
}

/// Covers the header from the job number on, and everything after it.
std::uint64_t checksum_of_block(std::span<const std::byte> block) {
  return checksum(block.subspan(offsetof(BlockHeader, job)));
}

}  // namespace

Digest digest_of_bytes(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.low64, hash.high64};
}

std::optional<std::uint64_t> SeedBlockBuilder::find(const Digest& fingerprint) const {
  const auto found = by_fingerprint_.find(fingerprint);
  if (found == by_fingerprint_.end()) return std::nullopt;
  return found->second;
}

std::uint64_t SeedBlockBuilder::add_content(std::string_view bytes, bool is_empty) {
  const Digest digest = digest_of_bytes(bytes);
  const auto [found, is_new] = by_digest_.try_emplace(digest, contents_.size());
  if (is_new) {
    contents_.push_back(
        {digest, data_.size(), static_cast<std::uint32_t>(bytes.size()), is_empty ? 1u : 0u});
    data_.append(bytes);
  }
  return found->second;
}

void SeedBlockBuilder::add_fingerprint(const Digest& fingerprint, std::uint64_t content) {
  by_fingerprint_.try_emplace(fingerprint, content);
}

void SeedBlockBuilder::add_tiles(int zoom, const PlaceRange& places, std::uint64_t content) {
  std::vector<BlockEntry>& entries = entries_[static_cast<std::size_t>(zoom)];
  if (!entries.empty()) {
    BlockEntry& last = entries.back();
    if (last.content == content && last.places.first + last.places.count == places.first) {
      last.places.count += places.count;
      return;
    }
  }
  entries.push_back({places, content});
}

std::vector<std::byte> SeedBlockBuilder::bytes(std::uint64_t job) const {
  BlockHeader header;
  header.mark = kBlockMark;
  header.job = job;
  header.figures = figures;
  header.contents = contents_.size();
  header.fingerprints = by_fingerprint_.size();
  for (std::size_t zoom = 0; zoom < entries_.size(); ++zoom) {
    header.entries[zoom] = entries_[zoom].size();
  }
  std::vector<std::byte> block(sizeof header);
  append(std::span(contents_), block);
  for (const auto& [fingerprint, content] : by_fingerprint_) {
    const BlockFingerprint item{fingerprint, content};
    append(std::span(&item, 1), block);
  }
  for (const auto& entries : entries_) append(std::span(entries), block);
  append(std::span(data_), block);
  block.resize((block.size() + kBlockAlignment - 1) / kBlockAlignment * kBlockAlignment);
  header.bytes = block.size();
  std::memcpy(block.data(), &header, sizeof header);
  header.checksum = checksum_of_block(block);
  std::memcpy(block.data(), &header, sizeof header);
  return block;
}

std::optional<SeedBlock> SeedBlock::read(std::span<const std::byte> bytes) {
  SeedBlock block;
  BlockHeader& header = block.header_;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.mark != kBlockMark || header.bytes < sizeof header || header.bytes > bytes.size()) {
    return std::nullopt;
  }
  bytes = bytes.first(header.bytes);
  if (checksum_of_block(bytes) != header.checksum) return std::nullopt;
  auto rest = bytes.subspan(sizeof header);
  const auto contents = take<BlockContent>(rest, header.contents);
  const auto fingerprints = take<BlockFingerprint>(rest, header.fingerprints);
  const auto count =
      std::accumulate(header.entries.begin(), header.entries.end(), std::uint64_t{0});
  const auto entries = take<BlockEntry>(rest, count);
  if (!contents || !fingerprints || !entries) return std::nullopt;
  block.contents_ = *contents;
  block.fingerprints_ = *fingerprints;
  block.entries_ = *entries;
  block.data_ = {reinterpret_cast<const char*>(rest.data()), rest.size()};
  const auto is_there = [&](const auto& item) { return item.content < header.contents; };
  const bool is_sound =
      std::ranges::all_of(*entries, is_there) && std::ranges::all_of(*fingerprints, is_there) &&
      std::ranges::all_of(*contents, [&](const BlockContent& content) {
        return content.offset <= rest.size() && content.length <= rest.size() - content.offset;
      });
  return is_sound ? std::optional(block) : std::nullopt;
}

std::span<const BlockEntry> SeedBlock::entries(int zoom) const {
  const auto begin = header_.entries.begin();
  const auto first = std::accumulate(begin, begin + zoom, std::uint64_t{0});
  return entries_.subspan(first, header_.entries[static_cast<std::size_t>(zoom)]);
}

}  // namespace trapeze
