// Text that is sent compressed, to whoever says that it takes that.
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

/// "gzip", "br"; "identity" is not said in headers.
std::string_view name_of(ContentEncoding encoding);

/// Those that this build makes, the smallest first.
std::span<const ContentEncoding> made_encodings();

/// Of `there`, the encoding that an Accept-Encoding header takes: the one that it gives the
/// greatest weight, of several the first; identity if it takes none. What is no such header takes
/// none.
ContentEncoding best_encoding(std::string_view accept_encoding,
                              std::span<const ContentEncoding> there = made_encodings());

/// Whether contents of that type become smaller: text, JSON, XML, SVG.
bool is_worth_compressing(std::string_view content_type);

/// Shorter contents are sent as they are.
constexpr std::size_t kLeastToCompress = 1024;

enum class Effort : std::uint8_t {
  quick,  // some 30 MB a second: for what is asked for now
  most,   // some 1 MB a second: for what is kept
};

/// The bytes in that encoding; nothing if this build does not make it, for identity, and where it
/// would not be smaller.
std::optional<std::string> compress(std::string_view bytes, ContentEncoding encoding,
                                    Effort effort);

/// The entity tag of contents in an encoding, by that of the contents as they are: each encoding
/// has its own, as a strong one wants.
std::string encoded_tag(const std::string& entity_tag, ContentEncoding encoding);

}  // namespace trapeze
