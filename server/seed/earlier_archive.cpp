#include "server/seed/earlier_archive.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "server/base/gzip.h"
#include "server/base/json_text.h"
#include "server/seed/seed_block.h"

namespace trapeze {
namespace {

constexpr std::size_t kPlaceOfMetadata = 24;  // in the header
constexpr std::size_t kMostMetadata = std::size_t{64} << 20;

std::uint64_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

/// The bytes at that position; nothing if they reach beyond the end.
std::optional<std::string_view> part_of(std::string_view bytes, std::uint64_t offset,
                                        std::uint64_t length) {
  if (offset > bytes.size() || length > bytes.size() - offset) return std::nullopt;
  return bytes.substr(offset, length);
}

/// Empty if there are none; nothing if this is not an archive of ours.
std::optional<std::string_view> stored_fingerprints(std::string_view bytes) {
  if (bytes.size() < kPmtilesHeaderBytes || !bytes.starts_with("PMTiles\x03")) return std::nullopt;
  const auto compressed = part_of(bytes, word_at(bytes, kPlaceOfMetadata),
                                  word_at(bytes, kPlaceOfMetadata + sizeof(std::uint64_t)));
  if (!compressed) return std::nullopt;
  const auto text = gunzip(*compressed, kMostMetadata);
  if (!text) return std::nullopt;
  const Json json = Json::parse(*text, nullptr, false);
  try {
    const Json& where = json.at(kPmtilesOwnMember).at("fingerprints");
    return part_of(bytes, where.at("offset"), where.at("length"));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace

EarlierArchive::EarlierArchive(const std::string& path) : file_(path) {
  const auto bytes = file_.bytes();
  const auto stored =
      stored_fingerprints({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const bool is_aligned =
      stored && reinterpret_cast<std::uintptr_t>(stored->data()) % alignof(StoredFingerprint) == 0;
  if (!is_aligned || stored->size() % sizeof(StoredFingerprint) != 0) {
    throw std::runtime_error(
        fmt::format("{}: not a PMTiles archive written by `trapeze seed`", path));
  }
  fingerprints_ = {reinterpret_cast<const StoredFingerprint*>(stored->data()),
                   stored->size() / sizeof(StoredFingerprint)};
}

std::optional<std::string> EarlierArchive::find(const Digest& fingerprint) const {
  const auto found =
      std::ranges::lower_bound(fingerprints_, fingerprint, {}, &StoredFingerprint::fingerprint);
  if (found == fingerprints_.end() || found->fingerprint != fingerprint) return std::nullopt;
  const auto bytes = file_.bytes();
  const auto part = part_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                            found->offset, found->length);
  if (!part || check_of(digest_of_bytes(*part)) != found->check) return std::nullopt;
  return std::string(*part);
}

}  // namespace trapeze
