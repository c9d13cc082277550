// Encodes pictures with the tile encoder and decodes them with libpng: no pixel changes, and no
// picture becomes much larger than its raw data.
//
// Input: width, height, how pixels are made, number of colours, four bytes a colour, then the data
// of the pixels: runs of two bytes (length and index), or one index byte each.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/picture/png.h"
#include "tests/fuzz/input_share.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::require;

constexpr std::size_t kHead = 4;
constexpr int kMaxSide = 40;
// For speed, only some inputs may request larger pictures, and only some are encoded twice.
constexpr int kLarger = 8;
constexpr std::uint32_t kInputsForLarger = 8;
constexpr std::uint32_t kInputsForTwice = 4;

/// Returns the bytes of an input, then zeros.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint8_t next() {
    if (bytes_.empty()) return 0;
    const std::uint8_t byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

Rgba next_colour(Bytes& bytes) {
  Rgba colour;
  for (std::uint8_t* part : {&colour.r, &colour.g, &colour.b, &colour.a}) *part = bytes.next();
  return colour;
}

Picture picture_from(Bytes bytes, bool can_be_larger) {
  Picture picture;
  picture.width = 1 + bytes.next() % kMaxSide;
  picture.height = 1 + bytes.next() % kMaxSide;
  const std::uint8_t way = bytes.next();
  if (can_be_larger && (way & 8) != 0) picture.width *= kLarger;
  if (can_be_larger && (way & 16) != 0) picture.height *= kLarger;
  const std::size_t colours = 1u + bytes.next();
  std::vector<Rgba> palette;
  for (std::size_t i = 0; i < colours; ++i) {
    palette.push_back(next_colour(bytes));
    if ((way & 4) != 0) palette.back().a = 255;
  }
  const auto count =
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  // Optionally uses more colours than a palette holds: those of a run shift from pixel to pixel.
  while (picture.pixels.size() < count) {
    const std::size_t length = (way & 1) != 0 ? 1 : std::size_t{1} + bytes.next();
    Rgba colour = palette[bytes.next() % colours];
    if ((way & 2) != 0) colour.g = static_cast<std::uint8_t>(colour.g + picture.pixels.size());
    picture.pixels.resize(std::min(count, picture.pixels.size() + length), colour);
  }
  return picture;
}

bool are_same(Rgba a, Rgba b) {
  return a == b || (a.a == 0 && b.a == 0);  // a wholly transparent colour is invisible
}

void check(std::span<const std::uint8_t> input) {
  if (input.size() < kHead) return;
  static PngEncoder encoder;
  const std::uint32_t hash = fuzzing::hash_of(input.data(), input.size());
  const Picture picture = picture_from(Bytes(input), hash % kInputsForLarger == 0);
  const RunPicture runs = to_runs(picture);
  const std::string bytes = encoder.encode(runs);
  const Picture decoded = decode_png(bytes);
  require(decoded.width == picture.width && decoded.height == picture.height,
          "a picture comes back in another size");
  require(std::ranges::equal(picture.pixels, decoded.pixels, are_same), "a pixel has changed");
  // Incompressible data is stored, with a few bytes per block; 1,100 bytes hold a palette.
  const auto pixels =
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  const std::size_t raw =
      pixels * (runs.colours.size() <= 256 ? 1 : 4) + static_cast<std::size_t>(picture.height);
  require(bytes.size() <= raw + raw / 64 + 1500, "a picture has become larger than its pixels");
  if (hash / kInputsForLarger % kInputsForTwice != 0) return;
  require(encoder.encode(runs) == bytes, "the same picture gives other bytes");
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check({data, size});
  return 0;
}
