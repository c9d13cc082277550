#include "render/picture/run_deflater.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace trapeze {
namespace {

constexpr std::uint32_t kLeastMatch = 3;
constexpr std::uint32_t kMostDistance = 32768;
constexpr std::uint32_t kEndOfBlock = 256;
constexpr std::uint32_t kColourBytes = 3;        // of a pixel, without opacity
constexpr std::uint32_t kFirstLength = 257;      // symbol of the shortest match
constexpr std::size_t kTokensOfRun = 6;          // maximum, except those of a match that is split
constexpr std::size_t kTokensOfBlock = 1 << 15;  // maximum, plus those of one row
constexpr int kMostCodeBits = 15;
constexpr std::uint64_t kAdler = 65521;
// Approximate bits of a token: the row above is used where that replaces more of them.
constexpr std::uint32_t kBitsOfLiteral = 6;
constexpr std::uint32_t kBitsOfRepeat = 6;
constexpr std::uint32_t kBitsOfMatchAbove = 10;
constexpr std::uint32_t kBitsOfMatchWithPast = 9;  // plus those of the distance

/// A symbol with extra bits.
struct Symbol {
  std::uint16_t symbol = 0;
  std::uint8_t extra_bits = 0;
  std::uint16_t extra = 0;
};

constexpr Symbol symbol_of_length(std::uint32_t length) {
  if (length == kLongestMatch) return {285, 0, 0};
  const std::uint32_t offset = length - kLeastMatch;
  if (offset < 8) return {static_cast<std::uint16_t>(kFirstLength + offset), 0, 0};
  const int extra_bits = static_cast<int>(std::bit_width(offset)) - 3;
  const std::uint32_t symbol =
      kFirstLength + 4 * static_cast<std::uint32_t>(extra_bits) + (offset >> extra_bits);
  return {static_cast<std::uint16_t>(symbol), static_cast<std::uint8_t>(extra_bits),
          static_cast<std::uint16_t>(offset & ((1u << extra_bits) - 1))};
}

constexpr Symbol symbol_of_distance(std::uint32_t distance) {
  const std::uint32_t offset = distance - 1;
  if (offset < 4) return {static_cast<std::uint16_t>(offset), 0, 0};
  const int extra_bits = static_cast<int>(std::bit_width(offset)) - 2;
  const std::uint32_t symbol = 2 * static_cast<std::uint32_t>(extra_bits) + (offset >> extra_bits);
  return {static_cast<std::uint16_t>(symbol), static_cast<std::uint8_t>(extra_bits),
          static_cast<std::uint16_t>(offset & ((1u << extra_bits) - 1))};
}

constexpr auto kSymbolsOfLengths = [] {
  std::array<Symbol, kLongestMatch + 1> symbols{};
  for (std::uint32_t i = kLeastMatch; i <= kLongestMatch; ++i) symbols[i] = symbol_of_length(i);
  return symbols;
}();

/// The code of a symbol followed by its extra bits.
template <typename Code>
Code joined(const Code& code, const Symbol& symbol) {
  return {code.bits | std::uint64_t{symbol.extra} << code.length, code.length + symbol.extra_bits};
}

std::uint16_t reversed(std::uint32_t bits, int length) {
  std::uint32_t result = 0;
  for (int i = 0; i < length; ++i) result |= (bits >> i & 1) << (length - 1 - i);
  return static_cast<std::uint16_t>(result);
}

/// Converts the counts of symbols, in ascending order, to the lengths of their Huffman codes, in
/// descending order (Moffat and Katajainen, "In-place calculation of minimum-redundancy codes",
/// 1995).
void to_code_lengths(std::span<std::uint32_t> counts) {
  const std::size_t size = counts.size();
  if (size == 1) {
    counts[0] = 1;
    return;
  }
  // Inner nodes replace the symbols that were joined, and point to their parents.
  counts[0] += counts[1];
  std::size_t root = 0;
  std::size_t leaf = 2;
  for (std::size_t next = 1; next < size - 1; ++next) {
    const auto take = [&] {
      if (leaf >= size || (root < next && counts[root] < counts[leaf])) {
        const std::uint32_t count = counts[root];
        counts[root++] = static_cast<std::uint32_t>(next);
        return count;
      }
      return counts[leaf++];
    };
    const std::uint32_t first = take();
    counts[next] = first + take();
  }
  // The depths of inner nodes.
  counts[size - 2] = 0;
  for (std::size_t i = size - 2; i-- > 0;) counts[i] = counts[counts[i]] + 1;
  // The depths of leaves.
  std::size_t available = 1;
  std::size_t used = 0;
  std::uint32_t depth = 0;
  std::size_t inner = size - 1;  // after the remaining ones
  std::size_t next = size;
  while (available > 0) {
    while (inner > 0 && counts[inner - 1] == depth) {
      ++used;
      --inner;
    }
    while (available > used) {
      counts[--next] = depth;
      --available;
    }
    available = 2 * used;
    ++depth;
    used = 0;
  }
}

/// Limits lengths, which are in descending order, so that their code stays complete.
void limit_lengths(std::span<std::uint32_t> lengths, int most) {
  const auto limit = static_cast<std::uint32_t>(most);
  if (lengths.front() <= limit) return;
  // By length; sums are in units of the longest code.
  std::array<std::uint32_t, 16> counts{};
  for (const std::uint32_t length : lengths) ++counts[std::min(length, limit)];
  std::uint32_t total = 0;
  for (std::uint32_t i = 1; i <= limit; ++i) total += counts[i] << (limit - i);
  for (; total > 1u << limit; --total) {
    // One of the longest leaves moves below a shorter one.
    --counts[limit];
    std::uint32_t shorter = limit - 1;
    while (counts[shorter] == 0) --shorter;
    --counts[shorter];
    counts[shorter + 1] += 2;
  }
  std::size_t i = 0;
  for (std::uint32_t length = limit; length > 0; --length) {
    for (std::uint32_t k = 0; k < counts[length]; ++k) lengths[i++] = length;
  }
}

}  // namespace

void RunDeflater::begin(std::uint32_t columns, std::uint32_t bytes_per_pixel) {
  columns_ = columns;
  bytes_per_pixel_ = bytes_per_pixel;
  stride_ = 1 + columns * bytes_per_pixel;
  above_.clear();
  begin_block();
  length_above_ = 0;
  row_byte_ = 0;
  if (bytes_per_pixel_ > 1) past_.begin(bytes_per_pixel_);
  sum_ = 1;
  sum_of_sums_ = 0;
  // A window of 32 kB, fastest compression, no dictionary.
  output_.assign({0x78, 0x01});
  bits_ = 0;
  bit_count_ = 0;
}

void RunDeflater::add_row(std::span<const PixelRun> runs) {
  if (token_count_ >= kTokensOfBlock) end_block(false);
  make_room(kTokensOfRun * runs.size() + stride_ / (kLongestMatch - kLeastMatch) + 1);
  add_to_checksum(runs);
  if (bytes_per_pixel_ == 1) {
    add_pixels<1>(runs);
  } else {
    past_.add_row(runs, row_byte_ + 1);
    add_pixels<0>(runs);
  }
  row_byte_ += stride_;
  above_.assign(runs.begin(), runs.end());
}

void RunDeflater::make_room(std::size_t tokens) {
  tokens += token_count_ + length_above_ / (kLongestMatch - kLeastMatch) + 1;
  if (tokens_.size() < tokens) tokens_.resize(tokens);
}

/// `size`: bytes per pixel, 0 if not known at compile time.
template <std::uint32_t size>
void RunDeflater::add_pixels(std::span<const PixelRun> runs) {
  Place place{0, runs.data(), above_.data(), 0};
  if (above_.empty() || stride_ > kMostDistance) {
    add_token(0);
    for (; place.column < columns_; ++place.run) {
      add_rest_of_run<size>(place);
      place.column = place.begin = place.run->end;
    }
    return;
  }
  // The filter byte is included in the match with the row above.
  Same first = same_as_above(place);
  first.bits += kBitsOfLiteral;
  if (is_worth_it(first)) {
    length_above_ += 1;
  } else {
    end_match_above();
    add_token(0);
  }
  while (true) {
    const Same same = same_as_above(place);
    const bool is_above = is_worth_it(same);
    const bool goes_on = is_above && length_above_ > 0;
    std::uint32_t matched = 0;
    if (size == 0 && !goes_on && place.column == place.begin) {
      const auto run = static_cast<std::size_t>(place.run - runs.data());
      matched = add_match_with_past(place, run, is_above ? same.bits - kBitsOfMatchAbove : 0);
    }
    if (matched > 0) {
      place.column += matched;
    } else if (is_above) {
      length_above_ += same.pixels * bytes_per_pixel_;
      place.column += same.pixels;
    } else {
      end_match_above();
      add_rest_of_run<size>(place);
      place.column = place.run->end;
    }
    if (place.column == columns_) return;
    for (; place.run->end <= place.column; ++place.run) place.begin = place.run->end;
    while (place.above->end <= place.column) ++place.above;
  }
}

std::span<const std::uint8_t> RunDeflater::finish() {
  end_block(true);
  for (; bit_count_ > 0; bit_count_ -= 8, bits_ >>= 8) {
    output_.push_back(static_cast<std::uint8_t>(bits_));
  }
  const auto checksum = static_cast<std::uint32_t>(sum_of_sums_ << 16 | sum_);
  for (int shift = 24; shift >= 0; shift -= 8) {
    output_.push_back(static_cast<std::uint8_t>(checksum >> shift));
  }
  return output_;
}

/// How far the row equals the one above; nothing where that is not worth determining.
inline RunDeflater::Same RunDeflater::same_as_above(const Place& place) const {
  const PixelRun* run = place.run;
  const PixelRun* above = place.above;
  // A single run takes as few bits by itself.
  const bool is_alike = run->pixel == above->pixel && (run->end == above->end || length_above_ > 0);
  Same same;
  if (!is_alike) return same;
  std::uint32_t column = place.column;
  std::uint32_t literals = column == place.begin ? bytes_per_pixel_ : 0;
  while (run->pixel == above->pixel) {
    const std::uint32_t end = std::min(run->end, above->end);
    const std::uint32_t bytes = (end - column) * bytes_per_pixel_;
    same.bits += bytes - literals >= kLeastMatch ? literals * kBitsOfLiteral + kBitsOfRepeat
                                                 : bytes * kBitsOfLiteral;
    column = end;
    if (run->end != above->end || end == columns_) break;
    ++run;
    ++above;
    literals = bytes_per_pixel_;
  }
  same.pixels = column - place.column;
  return same;
}

/// Whether referring to the row above takes fewer bits than writing the equal part.
inline bool RunDeflater::is_worth_it(const Same& same) const {
  const bool goes_on = length_above_ > 0 && same.pixels > 0;
  return goes_on ||
         (same.bits > kBitsOfMatchAbove && same.pixels * bytes_per_pixel_ >= kLeastMatch);
}

/// From that position on.
template <std::uint32_t size>
inline void RunDeflater::add_rest_of_run(const Place& place) {
  const std::uint32_t pixels = place.run->end - place.column;
  const std::uint32_t pixel = place.run->pixel;
  const std::uint32_t bytes_per_pixel = size == 0 ? bytes_per_pixel_ : size;
  // At the beginning of a run, the previous pixel is different.
  const std::uint32_t first = place.column == place.begin ? 1 : 0;
  const bool is_repeated = (pixels - first) * bytes_per_pixel >= kLeastMatch;
  const std::uint32_t literals = is_repeated ? first : pixels;
  if constexpr (size == 1) {
    // The case is unpredictable: all tokens are written, and only the needed ones kept.
    std::uint16_t* next = tokens_.data() + token_count_;
    for (std::uint32_t i = 0; i < kLeastMatch; ++i) next[i] = static_cast<std::uint16_t>(pixel);
    const std::uint32_t length = pixels - first;
    next[literals] = static_cast<std::uint16_t>(kRepeat + length);
    counts_[pixel] += literals;
    if (length <= kLongestMatch) {
      counts_[kRepeat + length] += is_repeated ? 1 : 0;
      token_count_ += literals + (is_repeated ? 1 : 0);
      return;
    }
    token_count_ += literals;
  } else {
    if (literals == 1 && differs_in_opacity_only(place)) {
      add_token(kRepeat + kColourBytes);
      add_token(pixel >> 24);
    } else {
      for (std::uint32_t i = 0; i < literals; ++i) add_pixel(pixel);
    }
    if (!is_repeated) return;
  }
  add_match(kRepeat, (pixels - first) * bytes_per_pixel);
}

// Adds a match from that position on, where that run of the row begins, if it saves more than
// `least_gain` bits. Returns its number of pixels; 0: none.
std::uint32_t RunDeflater::add_match_with_past(const Place& place, std::size_t run,
                                               std::uint32_t least_gain) {
  past_.pass(run);
  std::uint32_t most = least_gain;
  if (differs_in_opacity_only(place)) most += kColourBytes * kBitsOfLiteral - kBitsOfRepeat;
  PastRuns::Match best;
  for (const PastRuns::Match& match : past_.find(run)) {
    if (match.pixels * bytes_per_pixel_ < kLeastMatch || match.distance > kMostDistance) continue;
    const std::uint32_t without =
        match.runs * bytes_per_pixel_ * kBitsOfLiteral + match.repeats * kBitsOfRepeat;
    const std::uint32_t with = kBitsOfMatchWithPast + symbol_of_distance(match.distance).extra_bits;
    if (without <= with + most) continue;
    most = without - with;
    best = match;
  }
  if (best.pixels == 0) return 0;
  end_match_above();
  const std::uint32_t pixels = std::min(best.pixels, kLongestMatch / bytes_per_pixel_);
  add_token(kPast + pixels * bytes_per_pixel_);
  tokens_[token_count_++] = static_cast<std::uint16_t>(best.distance);
  ++past_counts_[symbol_of_distance(best.distance).symbol];
  return pixels;
}

// From the previous pixel, which is in the same row.
bool RunDeflater::differs_in_opacity_only(const Place& place) const {
  constexpr std::uint32_t kColour = 0xffffff;
  return bytes_per_pixel_ == 4 && place.column > 0 &&
         ((place.run[-1].pixel ^ place.run->pixel) & kColour) == 0;
}

void RunDeflater::add_pixel(std::uint32_t pixel) {
  for (std::uint32_t i = 0; i < bytes_per_pixel_; ++i) add_token(pixel >> 8 * i & 0xff);
}

inline void RunDeflater::add_token(std::uint32_t token) {
  tokens_[token_count_++] = static_cast<std::uint16_t>(token);
  ++counts_[token];
}

// Longer matches are split.
void RunDeflater::add_match(std::uint32_t kind, std::uint32_t length) {
  while (length > 0) {
    // No part is too short.
    std::uint32_t part = std::min(length, kLongestMatch);
    if (length > part && length - part < kLeastMatch) part -= kLeastMatch;
    add_token(kind + part);
    length -= part;
  }
}

inline void RunDeflater::end_match_above() {
  if (length_above_ > 0) add_match(kAbove, std::exchange(length_above_, 0));
}

// Adler-32 (RFC 1950): the sum of the bytes, and the sum of all partial sums.
void RunDeflater::add_to_checksum(std::span<const PixelRun> runs) {
  const std::uint64_t size = bytes_per_pixel_;
  const std::uint64_t bytes_that_count = size == 4 ? 0xffffffff : 0xffffff;
  // Each byte is included in all partial sums from its own on.
  std::uint64_t sum = 0;
  std::uint64_t sums = 0;
  std::uint64_t begin = 0;
  std::uint64_t distances_before = 0;
  for (const PixelRun& run : runs) {
    const std::uint64_t end = run.end;
    const std::uint64_t pixels = end - begin;
    // Of the pixels up to its end, to the end of the row.
    const std::uint64_t distances_up_to = end * (std::uint64_t{2} * columns_ + 1 - end) / 2;
    const std::uint64_t distances = distances_up_to - distances_before;
    begin = end;
    distances_before = distances_up_to;
    if (size == 1) {
      sum += pixels * run.pixel;
      sums += distances * run.pixel;
      continue;
    }
    // The later a byte of a pixel is, the less it counts.
    const std::uint64_t pixel = run.pixel & bytes_that_count;
    const std::uint64_t second = pixel >> 8 & 0xff;
    const std::uint64_t third = pixel >> 16 & 0xff;
    const std::uint64_t fourth = pixel >> 24;
    const std::uint64_t of_pixel = (pixel & 0xff) + second + third + fourth;
    sum += pixels * of_pixel;
    sums += distances * size * of_pixel - pixels * (second + 2 * third + 3 * fourth);
  }
  sums += sum_of_sums_ + sum_ * stride_;
  sum += sum_;
  sum_ = sum % kAdler;
  sum_of_sums_ = sums % kAdler;
}

void RunDeflater::begin_block() {
  token_count_ = 0;
  counts_.fill(0);
  past_counts_.fill(0);
}

void RunDeflater::end_block(bool is_last) {
  constexpr std::uint32_t kDynamicCodes = 2;
  constexpr std::size_t kMostBytesOfHeader = 400;
  make_room(0);
  end_match_above();
  std::array<std::uint32_t, kLiterals> literal_counts{};
  std::array<std::uint32_t, kDistances> distance_counts = past_counts_;
  const std::array<Symbol, 2> distances{symbol_of_distance(bytes_per_pixel_),
                                        symbol_of_distance(std::min(stride_, kMostDistance))};
  std::copy_n(counts_.begin(), kRepeat, literal_counts.begin());
  literal_counts[kEndOfBlock] = 1;
  for (std::size_t length = kLeastMatch; length <= kLongestMatch; ++length) {
    std::uint32_t& count = literal_counts[kSymbolsOfLengths[length].symbol];
    count += counts_[kPast + length];
    for (std::size_t kind = 0; kind < distances.size(); ++kind) {
      const std::uint32_t of_kind = counts_[(kind == 0 ? kRepeat : kAbove) + length];
      count += of_kind;
      distance_counts[distances[kind].symbol] += of_kind;
    }
  }
  const auto literal_codes = make_codes(literal_counts, kMostCodeBits);
  const auto distance_codes = make_codes(distance_counts, kMostCodeBits);
  std::copy_n(literal_codes.begin(), kRepeat, codes_.begin());
  for (std::size_t length = kLeastMatch; length <= kLongestMatch; ++length) {
    const Symbol& symbol = kSymbolsOfLengths[length];
    codes_[kPast + length] = joined(literal_codes[symbol.symbol], symbol);
  }
  for (std::size_t kind = 0; kind < distances.size(); ++kind) {
    const Code of_distance = joined(distance_codes[distances[kind].symbol], distances[kind]);
    for (std::size_t length = kLeastMatch; length <= kLongestMatch; ++length) {
      const Code& of_length = codes_[kPast + length];
      codes_[(kind == 0 ? kRepeat : kAbove) + length] = {
          of_length.bits | of_distance.bits << of_length.length,
          of_length.length + of_distance.length};
    }
  }
  past_codes_ = distance_codes;
  output_.reserve(output_.size() + kMostBytesOfHeader);
  write(is_last ? 1 : 0, 1);
  write(kDynamicCodes, 2);
  write_code_lengths(literal_codes, distance_codes);
  write_tokens();
  write(literal_codes[kEndOfBlock]);
  begin_block();
}

/// Assigns codes of at most that many bits to symbols with counts other than 0.
template <std::size_t size>
std::array<RunDeflater::Code, size> RunDeflater::make_codes(
    const std::array<std::uint32_t, size>& counts, int most_bits) {
  constexpr int kSymbolBits = 9;
  std::array<std::uint64_t, size> used;
  std::size_t count = 0;
  for (std::size_t symbol = 0; symbol < size; ++symbol) {
    if (counts[symbol] > 0) used[count++] = std::uint64_t{counts[symbol]} << kSymbolBits | symbol;
  }
  std::array<Code, size> codes{};
  if (count == 0) return codes;
  std::sort(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(count));
  std::array<std::uint32_t, size> lengths;
  for (std::size_t i = 0; i < count; ++i) {
    lengths[i] = static_cast<std::uint32_t>(used[i] >> kSymbolBits);
  }
  to_code_lengths({lengths.data(), count});
  limit_lengths({lengths.data(), count}, most_bits);
  // By length, the next code (RFC 1951, section 3.2.2).
  std::array<std::uint32_t, kMostCodeBits + 2> next{};
  for (std::size_t i = 0; i < count; ++i) {
    codes[used[i] & ((1u << kSymbolBits) - 1)].length = static_cast<int>(lengths[i]);
    ++next[lengths[i] + 1];
  }
  for (std::size_t i = 1; i < next.size(); ++i) next[i] = (next[i] + next[i - 1]) << 1;
  for (Code& code : codes) {
    if (code.length == 0) continue;
    code.bits = reversed(next[static_cast<std::size_t>(code.length)]++, code.length);
  }
  return codes;
}

// The first bit is the lowest one of the first byte. Eight bytes are stored for each token, of
// which only the full ones are kept.
void RunDeflater::write_tokens() {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t kMostBytesOfToken = 6;
  const std::size_t size = output_.size();
  output_.resize(size + kMostBytesOfToken * token_count_ + sizeof bits_);
  std::uint8_t* out = output_.data() + size;
  std::uint64_t bits = bits_;
  auto count = static_cast<unsigned>(bit_count_);
  const auto put = [&](const Code& code) {
    bits |= code.bits << count;
    count += static_cast<unsigned>(code.length);
    std::memcpy(out, &bits, sizeof bits);
    out += count / 8;
    bits >>= count / 8 * 8;
    count %= 8;
  };
  for (std::size_t i = 0; i < token_count_; ++i) {
    const std::uint16_t token = tokens_[i];
    put(codes_[token]);
    if (token >= kPast) put(code_of_distance(tokens_[++i]));
  }
  bits_ = bits;
  bit_count_ = static_cast<int>(count);
  output_.resize(static_cast<std::size_t>(out - output_.data()));
}

inline RunDeflater::Code RunDeflater::code_of_distance(std::uint32_t distance) const {
  const Symbol symbol = symbol_of_distance(distance);
  return joined(past_codes_[symbol.symbol], symbol);
}

/// Writes the lengths of all codes, run-length encoded, with a code of their own.
void RunDeflater::write_code_lengths(std::span<const Code, kLiterals> literal_codes,
                                     std::span<const Code, kDistances> distance_codes) {
  constexpr std::size_t kSymbols = 19;
  constexpr std::array<std::uint8_t, kSymbols> kOrder{16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                      11, 4,  12, 3, 13, 2, 14, 1, 15};
  constexpr std::size_t kLeastLiterals = 257;
  constexpr std::size_t kLeastDistances = 1;
  constexpr std::size_t kLeastLengths = 4;
  const auto used = [](const auto& codes, std::size_t least) {
    std::size_t count = codes.size();
    while (count > least && codes[count - 1].length == 0) --count;
    return count;
  };
  const std::size_t literals = used(literal_codes, kLeastLiterals);
  const std::size_t distances = used(distance_codes, kLeastDistances);
  std::array<std::uint8_t, kLiterals + kDistances> lengths;
  for (std::size_t i = 0; i < literals; ++i)
    lengths[i] = static_cast<std::uint8_t>(literal_codes[i].length);
  for (std::size_t i = 0; i < distances; ++i) {
    lengths[literals + i] = static_cast<std::uint8_t>(distance_codes[i].length);
  }

  std::array<Symbol, kLiterals + kDistances> symbols;
  std::size_t symbol_count = 0;
  std::array<std::uint32_t, kSymbols> counts{};
  const auto add = [&](std::uint16_t symbol, int extra_bits = 0, std::size_t extra = 0) {
    symbols[symbol_count++] = {symbol, static_cast<std::uint8_t>(extra_bits),
                               static_cast<std::uint16_t>(extra)};
    ++counts[symbol];
  };
  for (std::size_t i = 0; i < literals + distances;) {
    std::size_t end = i + 1;
    while (end < literals + distances && lengths[end] == lengths[i]) ++end;
    std::size_t left = end - i;
    if (lengths[i] == 0) {
      for (; left >= 11; left -= std::min<std::size_t>(left, 138)) {
        add(18, 7, std::min<std::size_t>(left, 138) - 11);
      }
      if (left >= 3) {
        add(17, 3, left - 3);
        left = 0;
      }
    } else {
      add(lengths[i]);
      for (--left; left >= 3; left -= std::min<std::size_t>(left, 6)) {
        add(16, 2, std::min<std::size_t>(left, 6) - 3);
      }
    }
    for (; left > 0; --left) add(lengths[i]);
    i = end;
  }

  const std::array<Code, kSymbols> codes = make_codes(counts, 7);
  std::size_t written = kSymbols;
  while (written > kLeastLengths && codes[kOrder[written - 1]].length == 0) --written;
  write(static_cast<std::uint32_t>(literals - kLeastLiterals), 5);
  write(static_cast<std::uint32_t>(distances - kLeastDistances), 5);
  write(static_cast<std::uint32_t>(written - kLeastLengths), 4);
  for (std::size_t i = 0; i < written; ++i)
    write(static_cast<std::uint32_t>(codes[kOrder[i]].length), 3);
  for (std::size_t i = 0; i < symbol_count; ++i) {
    write(codes[symbols[i].symbol]);
    write(symbols[i].extra, symbols[i].extra_bits);
  }
}

void RunDeflater::write(Code code) {
  bits_ |= code.bits << bit_count_;
  bit_count_ += code.length;
  for (; bit_count_ >= 8; bit_count_ -= 8, bits_ >>= 8) {
    output_.push_back(static_cast<std::uint8_t>(bits_));
  }
}

}  // namespace trapeze
