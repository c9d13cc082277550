// Compression by ISA-L, with the same bytes for the same input in every process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace trapeze {

/// Compresses one input after the other, with working memory that it keeps. One thread at a time
/// may use it.
class Deflater {
 public:
  /// Throws std::bad_alloc.
  Deflater();
  ~Deflater();
  Deflater(Deflater&&) noexcept;
  Deflater& operator=(Deflater&&) noexcept;

  /// A zlib stream (RFC 1950) of the input, which is shorter than 2^31 bytes. What it refers to
  /// stays until the next call. The bytes depend on nothing but the input, the version of ISA-L and
  /// the kind of processor. Throws std::bad_alloc, and std::runtime_error if ISA-L fails.
  std::span<const std::uint8_t> compress(std::span<const std::uint8_t> input);

 private:
  struct Stream;

  std::unique_ptr<Stream> stream_;
  std::vector<std::uint8_t> level_memory_;
  std::vector<std::uint8_t> output_;
};

}  // namespace trapeze
