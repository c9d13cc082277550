#include "core/layer/built_units.h"

namespace trapeze {

Digest digest_of(const Rings& rings) {
  Digester digester;
  digester.add(0);  // instead of the number of features
  digester.add(rings.size());
  for (const std::uint32_t end : rings.ends) digester.add(end);
  for (const Point p : rings.points) {
    digester.add(std::uint64_t{static_cast<std::uint32_t>(p.x)} << 32 |
                 static_cast<std::uint32_t>(p.y));
  }
  return digester.digest();
}

Digest digest_of(const Digest& rings, std::uint64_t own_class) {
  Digester digester;
  digester.add(rings.low);
  digester.add(rings.high);
  digester.add(own_class);
  return digester.digest();
}

Digest digest_of(std::span<const Digest> features) {
  Digester digester;
  digester.add(features.size());
  for (const Digest& feature : features) {
    digester.add(feature.low);
    digester.add(feature.high);
  }
  return digester.digest();
}

}  // namespace trapeze
