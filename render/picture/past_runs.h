// Finds earlier occurrences of pixels of several bytes in a picture, for Deflate to refer to.
//
// It remembers the last position of each colour, and of each pair of consecutive colours: in a
// picture with many boundaries, colours recur often, but rarely in longer sequences. So a look-up
// takes constant time for any picture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trapeze {

/// Equal pixels of a row.
struct PixelRun {
  std::uint32_t end = 0;    // the column after the last one
  std::uint32_t pixel = 0;  // its bytes, the first one lowest
};

/// Used for one picture after the other, with reused memory. One thread at a time.
class PastRuns {
 public:
  /// Pixels that equal those from a run on.
  struct Match {
    std::uint32_t distance = 0;  // in bytes
    std::uint32_t pixels = 0;    // 0: no match
    std::uint32_t runs = 0;      // number of runs that begin within them
    std::uint32_t repeats = 0;   // number of these with several pixels
  };

  /// Starts a picture with pixels of that many bytes.
  void begin(std::uint32_t bytes_per_pixel);
  /// Adds the next row, whose first pixel is at that byte of the picture.
  void add_row(std::span<const PixelRun> runs, std::uint32_t first_byte);
  /// Makes the runs of the row before this one available to find(). `run` must not be less than in
  /// the last call.
  void pass(std::size_t run);
  /// Matches for the pixels from a run of the row on, to which pass() has advanced: at the last
  /// position of its colour, and at the last position of its colour followed by the next one.
  std::array<Match, 2> find(std::size_t run) const;

 private:
  struct Past {
    std::uint32_t begin = 0;  // byte position
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
