// Requests that nobody sends in good faith: by hand, and made from them by chance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace trapeze::testing {

/// Targets that try to reach what they should not, or to confuse who reads them.
const std::vector<std::string>& hostile_targets();

/// Bytes of whole requests, or what pretends to be: those made by hand first, then mutations of
/// them, equal for equal seeds. At least as many as were made by hand.
std::vector<std::string> hostile_requests(std::size_t count, std::uint64_t seed);

}  // namespace trapeze::testing
