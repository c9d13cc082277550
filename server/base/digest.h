// Digests of contents that come from clients.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace trapeze {

/// The first 160 bits of SHA-256, as 40 hex digits: nobody can find two texts with the same digest.
/// Any thread.
std::string digest_of(std::string_view text);
/// The same for the concatenation of texts: the boundaries between them do not matter.
std::string digest_of(std::span<const std::string_view> parts);

}  // namespace trapeze
