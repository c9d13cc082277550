// Where in a picture pixels of several bytes were before, for Deflate to refer to them.
//
// What is remembered is the last place of each colour, and of each two that follow one another:
// where a picture has many boundaries, its colours come again and again, but seldom in longer
// sequences. So a look takes the same time whatever the picture is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trapeze {

/// Equal pixels of a row.
struct PixelRun {
  std::uint32_t end = 0;    // the column after the last of them
  std::uint32_t pixel = 0;  // its bytes, the first of them lowest
};

/// One picture after the other, with memory that is kept. One thread at a time.
class PastRuns {
 public:
  /// Pixels that are equal to those from a run on.
  struct Match {
    std::uint32_t distance = 0;  // in bytes
    std::uint32_t pixels = 0;    // 0: there is none
    std::uint32_t runs = 0;      // that begin within them
    std::uint32_t repeats = 0;   // of these, those of several pixels
  };

  /// Begins a picture with pixels of so many bytes.
  void begin(std::uint32_t bytes_per_pixel);
  /// Adds the next row, whose first pixel is that byte of the picture.
  void add_row(std::span<const PixelRun> runs, std::uint32_t first_byte);
  /// Lets those runs of the row be found that come before this one. It is not before the one of
  /// the last call.
  void pass(std::size_t run);
  /// For the pixels from a run of the row on, which has been passed to: where its colour was, and
  /// where its colour and the next one were.
  std::array<Match, 2> find(std::size_t run) const;

 private:
  struct Past {
    std::uint32_t begin = 0;  // byte
    std::uint32_t pixels = 0;
    std::uint32_t pixel = 0;
  };
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr int kSlotBits = 12;
  using Slots = std::array<std::uint32_t, std::size_t{1} << kSlotBits>;  // indices of runs

  void forget();
  bool goes_on(std::size_t run) const;
  Match match(std::size_t past, std::size_t here) const;

  static std::size_t slot_of(std::uint32_t pixel) {
    return pixel * 0x9e3779b1u >> (32 - kSlotBits);
  }
  static std::size_t slot_of(std::uint32_t pixel, std::uint32_t next) {
    return slot_of(pixel * 0x85ebca77u ^ next);
  }

  std::uint32_t bytes_per_pixel_ = 1;
  std::vector<Past> runs_;
  std::size_t first_of_row_ = 0;
  std::size_t passed_ = 0;
  Slots of_one_;
  Slots of_two_;
};

}  // namespace trapeze
