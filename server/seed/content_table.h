// The contents of an archive by digest, so that each is stored only once.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/grid/digest.h"
#include "server/seed/scratch_array.h"

namespace trapeze {

/// One thread at a time.
class ContentTable {
 public:
  struct Content {
    Digest digest;
    std::uint64_t place = 0;  // set by the archive: where the content is
    std::uint32_t length = 0;
    std::uint32_t is_there = 0;
  };
  struct Found {
    Content& content;
    bool is_new = false;
  };

  /// For up to `most` contents; the file is next to `path`, see ScratchFile.
  ContentTable(const std::string& path, std::uint64_t most)
      : slots_(path, std::bit_ceil(2 * most + 1)) {}

  /// Finds the content with that digest; adds it if it is missing.
  Found find_or_add(const Digest& digest) {
    const std::size_t mask = slots_.items().size() - 1;
    std::size_t i = digest.low & mask;
    while (slots_[i].is_there != 0 && slots_[i].digest != digest) i = (i + 1) & mask;
    Content& content = slots_[i];
    const bool is_new = content.is_there == 0;
    content.digest = digest;
    content.is_there = 1;
    return {content, is_new};
  }

 private:
  ScratchArray<Content> slots_;
};

}  // namespace trapeze
