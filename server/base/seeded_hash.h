// A hash for tables with data from clients. It differs from process to process, so attackers cannot
// predict which keys collide.
#pragma once

#include <cstdint>
#include <string_view>

namespace trapeze {

/// Equal for equal texts within one process. Any thread.
std::uint64_t seeded_hash(std::string_view text);

}  // namespace trapeze
