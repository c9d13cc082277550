#include "core/layer/built_units.h"

namespace trapeze {
namespace {

void add(const Rings& rings, Digester& digester) {
  digester.add(rings.size());
  for (const std::uint32_t end : rings.ends) digester.add(end);
  for (const Point p : rings.points) {
    digester.add(std::uint64_t{static_cast<std::uint32_t>(p.x)} << 32 |
                 static_cast<std::uint32_t>(p.y));
  }
}

}  // namespace

Digest digest_of(const Rings& rings) {
  Digester digester;
  digester.add(0);  // in place of the number of features
  add(rings, digester);
  return digester.digest();
}

Digest digest_of(std::span<const Rings* const> features) {
  Digester digester;
  digester.add(features.size());
  for (const Rings* rings : features) add(*rings, digester);
  return digester.digest();
}

}  // namespace trapeze
