// Reads PMTiles 3 according to its specification, sharing no code with the writer except gunzip().
#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/base/gzip.h"

namespace trapeze::testing {

class PmtilesReader {
 public:
  struct Entry {
    std::uint64_t id = 0;
    std::uint64_t run = 0;
    std::uint64_t length = 0;
    std::uint64_t offset = 0;
  };

  explicit PmtilesReader(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
    if (bytes_.size() < 127 || bytes_.substr(0, 7) != "PMTiles" || bytes_[7] != 3) {
      throw std::runtime_error("no PMTiles 3: " + path);
    }
  }

  std::uint64_t word(std::size_t offset) const {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes_.data() + offset, 8);
    return value;
  }
  std::uint8_t byte(std::size_t offset) const { return static_cast<std::uint8_t>(bytes_[offset]); }
  double degrees(std::size_t offset) const {
    std::int32_t value = 0;
    std::memcpy(&value, bytes_.data() + offset, 4);
    return value / 1e7;
  }
  std::uint64_t root_offset() const { return word(8); }
  std::uint64_t root_length() const { return word(16); }
  std::uint64_t leaves_length() const { return word(48); }
  std::uint64_t addressed_tiles() const { return word(72); }
  std::uint64_t tile_entries() const { return word(80); }
  std::uint64_t tile_contents() const { return word(88); }
  std::string metadata() const {
    return gunzip(bytes_.substr(word(24), word(32)), 1 << 24).value();
  }

  std::vector<Entry> directory(std::uint64_t offset, std::uint64_t length) const {
    const std::string text = gunzip(bytes_.substr(offset, length), 1 << 30).value();
    std::size_t at = 0;
    const auto varint = [&] {
      std::uint64_t value = 0;
      for (int shift = 0;; shift += 7) {
        const auto next = static_cast<std::uint8_t>(text.at(at++));
        value |= std::uint64_t{next & 0x7fu} << shift;
        if (next < 0x80) return value;
      }
    };
    std::vector<Entry> entries(varint());
    std::uint64_t id = 0;
    for (Entry& entry : entries) entry.id = id += varint();
    for (Entry& entry : entries) entry.run = varint();
    for (Entry& entry : entries) entry.length = varint();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::uint64_t value = varint();
      entries[i].offset =
          value > 0 ? value - 1 : entries.at(i - 1).offset + entries.at(i - 1).length;
    }
    return entries;
  }

  /// The entries of tiles, in order.
  std::vector<Entry> entries() const {
    std::vector<Entry> all;
    for (const Entry& entry : directory(root_offset(), root_length())) {
      if (entry.run > 0) {
        all.push_back(entry);
        continue;
      }
      const auto leaf = directory(word(40) + entry.offset, entry.length);
      all.insert(all.end(), leaf.begin(), leaf.end());
    }
    return all;
  }

  std::string tile(const Entry& entry) const {
    return bytes_.substr(word(56) + entry.offset, entry.length);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace trapeze::testing
