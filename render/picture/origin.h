// How colours of pictures come about.
#pragma once

#include <cstdint>

namespace trapeze {

enum class Origin : std::uint8_t {
  flat,   // as styles have it: of whole pixels, without any edge in them
  edge,   // one of even steps between two flat ones, along an edge
  mixed,  // otherwise
};

}  // namespace trapeze
