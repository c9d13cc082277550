// Compression of text for clients that accept it.
//
// Thread-safety: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace trapeze {

enum class ContentEncoding : std::uint8_t { identity, gzip, brotli };

/// "gzip", "br"; "identity" is not used in headers.
std::string_view name_of(ContentEncoding encoding);

/// The encodings that this build supports, the smallest output first.
std::span<const ContentEncoding> made_encodings();

/// The encoding of `there` that an Accept-Encoding header accepts with the greatest weight; the
/// first one in case of a tie, identity if none is accepted. An invalid header accepts none.
ContentEncoding best_encoding(std::string_view accept_encoding,
                              std::span<const ContentEncoding> there = made_encodings());

/// Whether compression reduces contents of that type: text, JSON, XML, SVG.
bool is_worth_compressing(std::string_view content_type);

/// Shorter contents are sent uncompressed.
constexpr std::size_t kLeastToCompress = 1024;

enum class Effort : std::uint8_t {
  quick,  // about 30 MB a second: for the current request
  most,   // about 1 MB a second: for contents that are kept
};

/// The bytes in that encoding; nothing if this build does not support it, if it is identity, or if
/// the result would not be smaller.
std::optional<std::string> compress(std::string_view bytes, ContentEncoding encoding,
                                    Effort effort);

/// The entity tag of contents in an encoding, derived from the tag of the plain contents: each
/// encoding needs its own, because the tags are strong.
std::string encoded_tag(const std::string& entity_tag, ContentEncoding encoding);

}  // namespace trapeze
