// A hash for tables of what clients send: nobody outside knows which keys meet in one slot, as it
// differs from process to process.
#pragma once

#include <cstdint>
#include <string_view>

namespace trapeze {

/// Equal within one process. Any thread.
std::uint64_t seeded_hash(std::string_view text);

}  // namespace trapeze
