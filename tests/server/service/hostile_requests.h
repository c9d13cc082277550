// Hostile requests: written by hand, and random mutations of these.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace trapeze::testing {

/// Targets that try to reach something forbidden or to confuse the parser.
const std::vector<std::string>& hostile_targets();

/// The bytes of whole requests, valid or not: first those written by hand, then mutations of them,
/// which are the same for the same seed. At least as many as were written by hand.
std::vector<std::string> hostile_requests(std::size_t count, std::uint64_t seed);

}  // namespace trapeze::testing
