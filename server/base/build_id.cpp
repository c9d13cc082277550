#include "server/base/build_id.h"

#include <spdlog/fmt/fmt.h>

#include <fstream>
#include <vector>

#include "server/base/content_hash.h"

namespace trapeze {
namespace {

std::string hash_of_executable() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20);
  ContentHash hash;
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash.add(std::string_view(block.data(), static_cast<std::size_t>(file.gcount())));
  }
  return fmt::format("{}-{}", version(), hash.hex());
}

}  // namespace

std::string version() {
  return TRAPEZE_VERSION;
}

const std::string& build_id() {
  static const std::string id = hash_of_executable();
  return id;
}

}  // namespace trapeze
