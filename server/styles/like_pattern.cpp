#include "server/styles/like_pattern.h"

#include <cstring>

namespace trapeze {
namespace {

constexpr std::size_t kBits = 64;    // per word
constexpr std::size_t kBytes = 256;  // possible values of a byte

bool continues_character(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

void set_bit(std::uint64_t* words, std::size_t place) {
  words[place / kBits] |= std::uint64_t{1} << place % kBits;
}

bool has_bit(const std::vector<std::uint64_t>& words, std::size_t place) {
  return (words[place / kBits] >> place % kBits & 1) != 0;
}

/// The number of bytes of the character that begins at `at`.
std::size_t character_size(std::string_view text, std::size_t at) {
  std::size_t size = 1;
  while (at + size < text.size() && continues_character(text[at + size])) ++size;
  return size;
}

}  // namespace

LikePattern::LikePattern(std::string_view pattern) : parts_(1) {
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '%') {
      parts_.emplace_back();
      continue;
    }
    const bool is_any = pattern[i] == '_';
    if (pattern[i] == '\\' && i + 1 < pattern.size()) ++i;
    parts_.back().bytes += pattern[i];
    parts_.back().is_any.push_back(is_any);
    parts_.back().has_any |= is_any;
  }
  for (std::size_t i = 1; i + 1 < parts_.size(); ++i) {
    if (parts_[i].has_any) note_places(parts_[i]);
  }
}

void LikePattern::note_places(Part& part) {
  part.places_of.resize(kBytes * part.words());
  part.any_places.resize(part.words());
  for (std::size_t i = 0; i < part.bytes.size(); ++i) {
    const auto byte = static_cast<unsigned char>(part.bytes[i]);
    set_bit(part.is_any[i] ? part.any_places.data() : &part.places_of[byte * part.words()], i);
  }
}

/// Matches both ends first. Then each part in the middle may take the first position where it
/// matches, since that leaves the most text to the parts after it.
bool LikePattern::matches(std::string_view text) const {
  if (!fits_at_begin(parts_.front(), text)) return false;
  if (parts_.size() == 1) return text.empty();
  if (!fits_at_end(parts_.back(), text)) return false;
  for (std::size_t i = 1; i + 1 < parts_.size(); ++i) {
    if (!take_first(parts_[i], text)) return false;
  }
  return true;
}

/// Removes the part from the text if it matches, here and below.
bool LikePattern::fits_at_begin(const Part& part, std::string_view& text) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < part.bytes.size(); ++i) {
    if (at == text.size()) return false;
    if (part.is_any[i]) {
      at += character_size(text, at);
    } else if (text[at++] != part.bytes[i]) {
      return false;
    }
  }
  text.remove_prefix(at);
  return true;
}

bool LikePattern::fits_at_end(const Part& part, std::string_view& text) {
  std::size_t end = text.size();
  for (std::size_t i = part.bytes.size(); i-- > 0;) {
    if (end == 0) return false;
    --end;
    if (part.is_any[i]) {
      while (end > 0 && continues_character(text[end])) --end;
    } else if (text[end] != part.bytes[i]) {
      return false;
    }
  }
  text = text.substr(0, end);
  return true;
}

bool LikePattern::take_first(const Part& part, std::string_view& text) {
  if (part.bytes.empty()) return true;
  if (part.has_any) return take_first_with_any(part, text);
  const void* found = memmem(text.data(), text.size(), part.bytes.data(), part.bytes.size());
  if (found == nullptr) return false;
  const auto begin = static_cast<std::size_t>(static_cast<const char*>(found) - text.data());
  text.remove_prefix(begin + part.bytes.size());
  return true;
}

/// Follows all positions of the part in parallel, with a bit for each that is set while the text
/// read last matches the part up to there. (Baeza-Yates and Gonnet, "A new approach to text
/// searching", 1992)
bool LikePattern::take_first_with_any(const Part& part, std::string_view& text) {
  const std::size_t words = part.words();
  std::vector<std::uint64_t> fits(words);
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool continues = continues_character(text[at]);
    const std::uint64_t* const places =
        &part.places_of[static_cast<unsigned char>(text[at]) * words];
    std::uint64_t carry = at == 0 || !continues ? 1 : 0;  // the part may begin here
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t next = fits[w] << 1 | carry;
      const std::uint64_t any = part.any_places[w];
      carry = fits[w] >> (kBits - 1);
      // Continuation bytes belong to the _ that matched the first byte of the character.
      fits[w] = (next & (places[w] | (continues ? 0 : any))) | (continues ? fits[w] & any : 0);
    }
    if (!has_bit(fits, part.bytes.size() - 1)) continue;
    text.remove_prefix(part.is_any.back() ? at + character_size(text, at) : at + 1);
    return true;
  }
  return false;
}

}  // namespace trapeze
