// What a removal must preserve of the topology (paper, section 3.3).
#pragma once

#include <cstdint>

#include "core/grid/name_table.h"

namespace trapeze {

enum class Topology : std::uint8_t {
  strict,  // the boundary never crosses itself, nor touches itself where it did not before
  fast,    // only the preconditions of the operators are tested, as in the paper's runs without the
           // test: the boundary may cross itself
};

inline constexpr NameTable<Topology, 2> kTopologyNames({
    {"fast", Topology::fast},
    {"strict", Topology::strict},
});

}  // namespace trapeze
