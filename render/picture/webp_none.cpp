// Replaces webp.cpp in builds without libwebp.
#include <stdexcept>

#include "render/picture/webp.h"

namespace trapeze {

bool has_webp() {
  return false;
}

int webp_version() {
  return 0;
}

std::string encode_webp(const RunPicture&) {
  throw std::runtime_error("this program was built without libwebp");
}

}  // namespace trapeze
