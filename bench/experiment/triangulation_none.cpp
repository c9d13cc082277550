#include <stdexcept>

#include "bench/experiment/triangulation.h"

namespace trapeze::experiment {

struct Triangulation::State {};

bool has_triangulation() {
  return false;
}

Triangulation::Triangulation() {
  throw std::runtime_error("this program was built without CGAL (libcgal-dev)");
}
Triangulation::~Triangulation() = default;

void Triangulation::triangulate(const Rings&, std::uint32_t, std::uint32_t, const Box&,
                                TrapezoidList&) {}

}  // namespace trapeze::experiment
