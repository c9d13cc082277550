// How colours of pictures originate.
#pragma once

#include <cstdint>

namespace trapeze {

enum class Origin : std::uint8_t {
  flat,   // as in the style: of whole pixels, without an edge in them
  edge,   // one of the even steps between two flat colours, along an edge
  mixed,  // any other
};

}  // namespace trapeze
