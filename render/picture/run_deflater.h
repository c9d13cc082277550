// Deflate (RFC 1951) for pictures that consist of runs of equal pixels.
//
// In such pictures, nearly all repetition is within a run, or equals the row above, or, for pixels
// of several bytes, follows an earlier occurrence of the same colour. So no search for matches is
// needed, and the checksum of a run has a closed form. Compressing therefore takes time in
// proportion to the runs and not to the pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/past_runs.h"

namespace trapeze {

constexpr std::uint32_t kLongestMatch = 258;  // in Deflate, in bytes

/// Compresses one picture after the other, with reused working memory. One thread at a time.
class RunDeflater {
 public:
  /// Starts a picture with that many columns and with pixels of 1, 3 or 4 bytes.
  void begin(std::uint32_t columns, std::uint32_t bytes_per_pixel);
  /// Adds the next row: a byte 0, which is the filter type that PNG has before each row, and its
  /// pixels. Precondition: the runs are consecutive and fill all columns.
  void add_row(std::span<const PixelRun> runs);
  /// A zlib stream (RFC 1950) of all rows, valid until the next picture begins. It depends on the
  /// rows only.
  std::span<const std::uint8_t> finish();

 private:
  /// The code of a symbol, or of a token.
  struct Code {
    std::uint64_t bits = 0;
    int length = 0;  // 0: does not occur
  };
  static constexpr std::size_t kLiterals = 286;  // including lengths, and the end of a block
  static constexpr std::size_t kDistances = 30;
  // Tokens: literals; then, by length, matches with the previous pixel, with the row above, and
  // with earlier data at the distance given by the next token.
  static constexpr std::uint32_t kRepeat = 256;
  static constexpr std::uint32_t kAbove = kRepeat + kLongestMatch + 1;
  static constexpr std::uint32_t kPast = kAbove + kLongestMatch + 1;
  static constexpr std::size_t kTokens = kPast + kLongestMatch + 1;

  /// A position in a row.
  struct Place {
    std::uint32_t column = 0;
    const PixelRun* run = nullptr;    // of the row; does not end before the column
    const PixelRun* above = nullptr;  // run of the row above
    std::uint32_t begin = 0;          // of the run
  };
  /// The part that equals the row above.
  struct Same {
    std::uint32_t pixels = 0;
    std::uint32_t bits = 0;  // approximate size if it were written
  };

  Same same_as_above(const Place& place) const;
  bool is_worth_it(const Same& same) const;
  void make_room(std::size_t tokens);
  template <std::uint32_t size>
  void add_pixels(std::span<const PixelRun> runs);
  template <std::uint32_t size>
  void add_rest_of_run(const Place& place);
  std::uint32_t add_match_with_past(const Place& place, std::size_t run, std::uint32_t least_gain);
  bool differs_in_opacity_only(const Place& place) const;
  void add_pixel(std::uint32_t pixel);
  void add_token(std::uint32_t token);
  void add_match(std::uint32_t kind, std::uint32_t length);
  void end_match_above();
  void add_to_checksum(std::span<const PixelRun> runs);

  void begin_block();
  void end_block(bool is_last);
  void write_tokens();
  Code code_of_distance(std::uint32_t distance) const;
  void write_code_lengths(std::span<const Code, kLiterals> literal_codes,
                          std::span<const Code, kDistances> distance_codes);
  template <std::size_t size>
  static std::array<Code, size> make_codes(const std::array<std::uint32_t, size>& counts,
                                           int most_bits);
  void write(Code code);
  void write(std::uint32_t bits, int count) { write(Code{bits, count}); }

  std::uint32_t columns_ = 0;
  std::uint32_t bytes_per_pixel_ = 1;
  std::uint32_t stride_ = 1;           // bytes of a row
  std::vector<PixelRun> above_;        // the runs of the previous row; empty: none
  std::vector<std::uint16_t> tokens_;  // with spare room
  std::size_t token_count_ = 0;
  std::array<std::uint32_t, kTokens> counts_{};
  std::array<std::uint32_t, kDistances> past_counts_{};  // of distances, which are tokens
  std::array<Code, kTokens> codes_{};
  std::array<Code, kDistances> past_codes_{};
  PastRuns past_;                   // for pixels of several bytes
  std::uint32_t row_byte_ = 0;      // position of the row
  std::uint32_t length_above_ = 0;  // of a match with the row above that may continue
  // Adler-32.
  std::uint64_t sum_ = 1;
  std::uint64_t sum_of_sums_ = 0;
  // The output.
  std::vector<std::uint8_t> output_;
  std::uint64_t bits_ = 0;
  int bit_count_ = 0;
};

}  // namespace trapeze
