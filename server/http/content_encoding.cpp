#include "server/http/content_encoding.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <new>
#include <stdexcept>

#include "server/base/gzip.h"
#include "server/base/trimmed.h"

#ifdef TRAPEZE_HAS_BROTLI
#include <brotli/encode.h>
#endif

namespace trapeze {
namespace {

#ifdef TRAPEZE_HAS_BROTLI
constexpr std::array kMade = {ContentEncoding::brotli, ContentEncoding::gzip};
#else
constexpr std::array kMade = {ContentEncoding::gzip};
#endif

std::string_view take_until(char separator, std::string_view& text) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view taken = trimmed(text.substr(0, end));
  text.remove_prefix(std::min(end + 1, text.size()));
  return taken;
}

bool is_same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// The q of ";q=0.5", in [0, 1]; 1 if there is none, 0 if it is invalid.
double weight_of(std::string_view parameters) {
  while (!parameters.empty()) {
    std::string_view value = take_until(';', parameters);
    if (!is_same_word(take_until('=', value), "q")) continue;
    double weight = 0;
    const auto read = std::from_chars(value.data(), value.data() + value.size(), weight);
    const bool is_number = read.ec == std::errc() && read.ptr == value.data() + value.size();
    return is_number && weight >= 0 && weight <= 1 ? weight : 0;
  }
  return 1;
}

/// The weight of an encoding; 0: not accepted.
double weight_of(ContentEncoding encoding, std::string_view accept_encoding) {
  double others = 0;
  while (!accept_encoding.empty()) {
    std::string_view parameters = take_until(',', accept_encoding);
    const std::string_view name = take_until(';', parameters);
    if (is_same_word(name, name_of(encoding))) return weight_of(parameters);
    if (encoding == ContentEncoding::gzip && is_same_word(name, "x-gzip")) {
      return weight_of(parameters);
    }
    if (name == "*") others = weight_of(parameters);
  }
  return others;
}

int gzip_level(Effort effort) {
  constexpr int kQuick = 5;
  return effort == Effort::most ? kMostGzipLevel : kQuick;
}

#ifdef TRAPEZE_HAS_BROTLI
std::string brotli(std::string_view bytes, Effort effort) {
  std::size_t size = BrotliEncoderMaxCompressedSize(bytes.size());
  std::string compressed(size, '\0');
  const int quality = effort == Effort::most ? BROTLI_MAX_QUALITY : 5;
  if (BrotliEncoderCompress(quality, BROTLI_DEFAULT_WINDOW, BROTLI_MODE_TEXT, bytes.size(),
                            reinterpret_cast<const std::uint8_t*>(bytes.data()), &size,
                            reinterpret_cast<std::uint8_t*>(compressed.data())) == BROTLI_FALSE) {
    throw std::bad_alloc();
  }
  compressed.resize(size);
  return compressed;
}
#endif

std::optional<std::string> compressed(std::string_view bytes, ContentEncoding encoding,
                                      Effort effort) {
  switch (encoding) {
    case ContentEncoding::identity:
      return std::nullopt;
    case ContentEncoding::gzip:
      return gzip(bytes, gzip_level(effort));
    case ContentEncoding::brotli:
#ifdef TRAPEZE_HAS_BROTLI
      return brotli(bytes, effort);
#else
      return std::nullopt;
#endif
  }
  return std::nullopt;
}

}  // namespace

std::string_view name_of(ContentEncoding encoding) {
  switch (encoding) {
    case ContentEncoding::gzip:
      return "gzip";
    case ContentEncoding::brotli:
      return "br";
    case ContentEncoding::identity:
      break;
  }
  return "identity";
}

std::span<const ContentEncoding> made_encodings() {
  return kMade;
}

ContentEncoding best_encoding(std::string_view accept_encoding,
                              std::span<const ContentEncoding> there) {
  ContentEncoding best = ContentEncoding::identity;
  double most = 0;
  for (const ContentEncoding encoding : there) {
    const double weight = weight_of(encoding, accept_encoding);
    if (weight <= most) continue;
    best = encoding;
    most = weight;
  }
  return best;
}

bool is_worth_compressing(std::string_view content_type) {
  const std::string_view type = take_until(';', content_type);
  return type.starts_with("text/") || type.ends_with("json") || type.ends_with("xml") ||
         type == "application/javascript";
}

std::optional<std::string> compress(std::string_view bytes, ContentEncoding encoding,
                                    Effort effort) {
  if (bytes.size() > kMostGzipBytes) return std::nullopt;
  auto smaller = compressed(bytes, encoding, effort);
  if (smaller && smaller->size() >= bytes.size()) smaller.reset();
  return smaller;
}

std::string encoded_tag(const std::string& entity_tag, ContentEncoding encoding) {
  if (encoding == ContentEncoding::identity || !entity_tag.ends_with('"')) return entity_tag;
  std::string tag = entity_tag;
  tag.insert(tag.size() - 1, "-" + std::string(name_of(encoding)));
  return tag;
}

}  // namespace trapeze
