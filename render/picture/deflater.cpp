#include "render/picture/deflater.h"

#include <isa-l/igzip_lib.h>
#include <sys/mman.h>

#include <algorithm>
#include <new>
#include <stdexcept>

namespace trapeze {
namespace {

// ISA-L 2.30 takes the address of the stream, without its last 16 bits, for the third string of
// four bytes of an input: where that string is remembered depends on the address, and with it, for
// one input in some thousands, which matches are found. So streams lie at addresses of one hash.
constexpr std::uintptr_t kStep = std::uintptr_t{1} << 16;
constexpr std::uint32_t kHashes = 1u << 13;
// Any would do. That of four zeros, 0, would cost a match in every empty tile.
constexpr std::uint32_t kHash = 0x1555;
constexpr std::uintptr_t kSteps = 512 * kHashes;  // for as many streams: one in kHashes has it

std::uintptr_t number_of(const void* address) {
  return reinterpret_cast<std::uintptr_t>(address);
}

// As the processor computes it: CRC-32C of four bytes, without its inversions.
std::uint32_t hash_of(const void* address) {
  auto crc = static_cast<std::uint32_t>(number_of(address) / kStep);
  for (int i = 0; i < 32; ++i) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78u : 0);
  return crc & (kHashes - 1);
}

// Null if it fails.
void* map(void* address, int flags) {
  constexpr int kNoFile = -1;
  void* place = mmap(address, sizeof(isal_zstream), PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | flags, kNoFile, 0);
  return place == MAP_FAILED ? nullptr : place;
}

void unmap(void* place) {
  munmap(place, sizeof(isal_zstream));
}

// Below where the system would place it. Where nothing is free it is there, and all that is lost is
// that bytes are the same.
void* map_stream() {
  void* usual = map(nullptr, 0);
  if (usual == nullptr) throw std::bad_alloc();
  char* top = static_cast<char*>(usual) - number_of(usual) % kStep;
  const std::uintptr_t steps = std::min(kSteps, number_of(top) / kStep);
  for (std::uintptr_t i = 0; i < steps; ++i) {
    void* wanted = top - i * kStep;
    if (hash_of(wanted) != kHash) continue;
    void* place = map(wanted, MAP_FIXED_NOREPLACE);
    if (place == nullptr) continue;
    if (place == wanted) {
      unmap(usual);
      return place;
    }
    unmap(place);  // of a system that does not know the flag
  }
  return usual;
}

}  // namespace

struct Deflater::Stream {
  void* const place = map_stream();

  Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { unmap(place); }
};

Deflater::Deflater() : stream_(std::make_unique<Stream>()), level_memory_(ISAL_DEF_LVL1_DEFAULT) {}
Deflater::~Deflater() = default;
Deflater::Deflater(Deflater&&) noexcept = default;
Deflater& Deflater::operator=(Deflater&&) noexcept = default;

// At level 1: in a fifth of the time that zlib and libdeflate take at theirs, to about the size of
// zlib's level 6 (flat colours are runs, and runs are what it is good at).
std::span<const std::uint8_t> Deflater::compress(std::span<const std::uint8_t> input) {
  output_.resize(input.size() + input.size() / 64 + ISAL_DEF_MAX_HDR_SIZE + 64);
  isal_zstream& stream = *static_cast<isal_zstream*>(stream_->place);
  isal_deflate_stateless_init(&stream);
  stream.hist_bits = 0;  // the whole window: not set by init
  stream.level = 1;
  stream.level_buf = level_memory_.data();
  stream.level_buf_size = static_cast<std::uint32_t>(level_memory_.size());
  stream.gzip_flag = IGZIP_ZLIB;
  stream.end_of_stream = 1;
  stream.next_in = const_cast<std::uint8_t*>(input.data());  // which ISA-L only reads
  stream.avail_in = static_cast<std::uint32_t>(input.size());
  stream.next_out = output_.data();
  stream.avail_out = static_cast<std::uint32_t>(output_.size());
  if (isal_deflate_stateless(&stream) != COMP_OK) {
    throw std::runtime_error("compressing failed: ISA-L does not take the input");
  }
  return {output_.data(), stream.total_out};
}

}  // namespace trapeze
