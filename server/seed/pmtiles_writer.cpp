#include "server/seed/pmtiles_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "server/base/build_id.h"
#include "server/base/gzip.h"
#include "server/base/json_text.h"
#include "server/tiles/painted_tile.h"

namespace trapeze {
namespace {

constexpr std::uint64_t kBeginOfTiles = 16'384;  // the first request of readers ends here
constexpr std::uint64_t kMostOfRoot = kBeginOfTiles - kPmtilesHeaderBytes - 1;  // as specified
constexpr std::size_t kLeastLeaf = 4096;                                        // entries
constexpr std::size_t kBuffer = std::size_t{1} << 20;
constexpr std::uint64_t kMostRun = std::numeric_limits<std::uint32_t>::max();

void append_varint(std::uint64_t value, std::string& bytes) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<char>(value | 0x80));
  bytes.push_back(static_cast<char>(value));
}

template <typename Integer>
void append_little_endian(Integer value, std::string& bytes) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    bytes.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i & 0xff));
  }
}

/// A directory as specified: column by column, then compressed.
std::string directory_of(std::span<const PmtilesEntry> entries) {
  std::string bytes;
  append_varint(entries.size(), bytes);
  std::uint64_t last = 0;
  for (const PmtilesEntry& entry : entries) {
    append_varint(entry.id - last, bytes);
    last = entry.id;
  }
  for (const PmtilesEntry& entry : entries) append_varint(entry.run, bytes);
  for (const PmtilesEntry& entry : entries) append_varint(entry.length, bytes);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const bool goes_on =
        i > 0 && entries[i].offset == entries[i - 1].offset + entries[i - 1].length;
    append_varint(goes_on ? 0 : entries[i].offset + 1, bytes);
  }
  return gzip(bytes, kMostGzipLevel);
}

/// Ten-millionths of a degree.
std::int32_t stored_degrees(double degrees) {
  return static_cast<std::int32_t>(std::lround(degrees * 1e7));
}

}  // namespace

PmtilesWriter::PmtilesWriter(const std::string& path, ArchiveDescription description,
                             const ArchiveSize& size)
    : description_(std::move(description)),
      file_(path),
      contents_(path, size.contents),
      entries_(path, size.entries),
      fingerprints_(path, size.fingerprints) {
  append(std::string(kBeginOfTiles, '\0'));
}

void PmtilesWriter::append(std::string_view bytes) {
  buffer_.append(bytes);
  end_ += bytes.size();
  if (buffer_.size() >= kBuffer) flush();
}

void PmtilesWriter::flush() {
  file_.write(std::as_bytes(std::span(buffer_)));
  buffer_.clear();
}

void PmtilesWriter::add(const ArchiveTiles& tiles) {
  const auto [content, is_new] = contents_.find_or_add(tiles.digest);
  if (is_new) {
    content.place = end_;
    content.length = static_cast<std::uint32_t>(tiles.bytes.size());
    ++content_count_;
    append(tiles.bytes);
  }
  add_entries(first_id_of_zoom(tiles.zoom) + tiles.places.first, tiles.places.count, content);
}

// Tiles are consecutive across zooms, too.
void PmtilesWriter::add_entries(std::uint64_t id, std::uint64_t count,
                                const ContentTable::Content& content) {
  tile_count_ += count;
  const std::uint64_t offset = content.place - kBeginOfTiles;
  while (count > 0) {
    const auto run = static_cast<std::uint32_t>(std::min(count, kMostRun));
    entries_[entry_count_++] = {id, offset, content.length, run};
    id += run;
    count -= run;
  }
}

void PmtilesWriter::add_fingerprint(const Digest& fingerprint, const Digest& content) {
  const ContentTable::Content& found = contents_.find_or_add(content).content;
  fingerprints_[fingerprint_count_++] = {fingerprint, found.place, found.length, check_of(content)};
}

void PmtilesWriter::finish() {
  const std::uint64_t end_of_data = end_;
  const Directories directories = write_directories();
  const Section fingerprints = write_fingerprints();
  const std::string text = gzip(metadata(fingerprints), kMostGzipLevel);
  const Section where{end_, text.size()};
  append(text);
  flush();
  const std::string front = header(directories, where, end_of_data) + directories.root;
  file_.write_at(0, std::as_bytes(std::span(front)));
  file_.finish();
}

// Leaves are as small as possible with a root that fits into its place.
PmtilesWriter::Directories PmtilesWriter::write_directories() {
  const std::span<const PmtilesEntry> entries = entries_.items().first(entry_count_);
  const std::uint64_t begin = end_;
  std::string root = entries.size() <= kLeastLeaf ? directory_of(entries) : std::string();
  if (!root.empty() && root.size() <= kMostOfRoot) return {root, {begin, 0}};
  for (std::size_t of_leaf = kLeastLeaf;; of_leaf *= 2) {
    std::vector<std::string> leaves;
    std::vector<PmtilesEntry> pointers;
    std::uint64_t offset = 0;
    for (std::size_t i = 0; i < entries.size(); i += of_leaf) {
      const auto leaf = entries.subspan(i, std::min(of_leaf, entries.size() - i));
      leaves.push_back(directory_of(leaf));
      const auto length = static_cast<std::uint32_t>(leaves.back().size());
      pointers.push_back({leaf.front().id, offset, length, 0});
      offset += length;
    }
    root = directory_of(pointers);
    if (root.size() > kMostOfRoot) continue;
    for (const std::string& leaf : leaves) append(leaf);
    return {root, {begin, end_ - begin}};
  }
}

PmtilesWriter::Section PmtilesWriter::write_fingerprints() {
  const auto stored = fingerprints_.items().first(fingerprint_count_);
  std::ranges::sort(stored, {}, &StoredFingerprint::fingerprint);
  const auto end = std::unique(stored.begin(), stored.end(), [](const auto& a, const auto& b) {
    return a.fingerprint == b.fingerprint;
  });
  constexpr std::size_t kAlignment = alignof(StoredFingerprint);
  append(std::string((kAlignment - end_ % kAlignment) % kAlignment, '\0'));
  const Section section{
      end_, static_cast<std::uint64_t>(end - stored.begin()) * sizeof(StoredFingerprint)};
  for (auto item = stored.begin(); item != end; ++item) {
    append({reinterpret_cast<const char*>(&*item), sizeof *item});
  }
  return section;
}

std::string PmtilesWriter::metadata(const Section& fingerprints) const {
  const ArchiveDescription& d = description_;
  Json json = {{"name", d.name}};
  if (!d.description.empty()) json["description"] = d.description;
  if (!d.attribution.empty()) json["attribution"] = d.attribution;
  json["type"] = "overlay";
  json["format"] = kTileFormatNames.name_of(d.format);
  json["bounds"] = d.bounds;
  json["minzoom"] = d.zooms.first;
  json["maxzoom"] = d.zooms.last;
  json["generator"] = "trapeze " + std::string(version());
  json[kPmtilesOwnMember] = {
      {"layers", d.layers},
      {"style", d.style},
      {"scale", d.scale},
      {"picture_version", kPictureVersion},
      {"fingerprints", {{"offset", fingerprints.offset}, {"length", fingerprints.length}}}};
  return to_text(json);
}

std::string PmtilesWriter::header(const Directories& directories, const Section& metadata,
                                  std::uint64_t end_of_data) const {
  constexpr std::uint8_t kVersion = 3;
  constexpr std::uint8_t kUncompressed = 1;
  constexpr std::uint8_t kGzip = 2;
  constexpr std::uint8_t kPng = 2;
  constexpr std::uint8_t kWebp = 4;
  const auto [west, south, east, north] = description_.bounds;
  const auto first_zoom = static_cast<std::uint8_t>(description_.zooms.first);
  const auto last_zoom = static_cast<std::uint8_t>(description_.zooms.last);
  std::string bytes = "PMTiles";
  append_little_endian(kVersion, bytes);
  const Section tiles{kBeginOfTiles, end_of_data - kBeginOfTiles};
  const Section root{kPmtilesHeaderBytes, directories.root.size()};
  for (const Section& section : {root, metadata, directories.leaves, tiles}) {
    append_little_endian(section.offset, bytes);
    append_little_endian(section.length, bytes);
  }
  for (const std::uint64_t count : {tile_count_, entry_count_, content_count_}) {
    append_little_endian(count, bytes);
  }
  constexpr std::uint8_t kClustered = 1;
  const std::uint8_t type = description_.format == TileFormat::webp ? kWebp : kPng;
  for (const std::uint8_t byte : {kClustered, kGzip, kUncompressed, type, first_zoom, last_zoom}) {
    append_little_endian(byte, bytes);
  }
  for (const double degrees : {west, south, east, north}) {
    append_little_endian(stored_degrees(degrees), bytes);
  }
  append_little_endian(first_zoom, bytes);
  for (const double degrees : description_.center) {
    append_little_endian(stored_degrees(degrees), bytes);
  }
  return bytes;
}

}  // namespace trapeze
