#include "server/base/content_hash.h"

#include <spdlog/fmt/fmt.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace trapeze {

struct ContentHash::State {
  XXH3_state_t of_xxh3;
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->of_xxh3);
}

ContentHash::~ContentHash() = default;

void ContentHash::add(std::uint64_t word) {
  XXH3_128bits_update(&state_->of_xxh3, &word, sizeof word);
}

void ContentHash::add(std::string_view text) {
  add(text.size());
  XXH3_128bits_update(&state_->of_xxh3, text.data(), text.size());
}

std::uint64_t ContentHash::value() const {
  return XXH3_128bits_digest(&state_->of_xxh3).low64;
}

std::string ContentHash::hex() const {
  const XXH128_hash_t digest = XXH3_128bits_digest(&state_->of_xxh3);
  return fmt::format("{:016x}{:016x}", digest.high64, digest.low64);
}

}  // namespace trapeze
