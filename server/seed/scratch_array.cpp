#include "server/seed/scratch_array.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

namespace trapeze {
namespace {

[[noreturn]] void fail_to_write_beside(const std::string& path, int error) {
  throw std::runtime_error(
      fmt::format("cannot write beside {}: {}", path, std::generic_category().message(error)));
}

}  // namespace

ScratchFile::ScratchFile(const std::string& path, std::size_t bytes) {
  if (bytes == 0) return;
  std::string name = path + ".XXXXXX";
  const int file = mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) fail_to_write_beside(path, errno);
  unlink(name.c_str());
  int error = posix_fallocate(file, 0, static_cast<off_t>(bytes));
  void* memory = MAP_FAILED;
  if (error == 0) {
    memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    error = errno;
  }
  close(file);
  if (memory == MAP_FAILED) fail_to_write_beside(path, error);
  bytes_ = {static_cast<std::byte*>(memory), bytes};
}

ScratchFile::~ScratchFile() {
  if (!bytes_.empty()) munmap(bytes_.data(), bytes_.size());
}

}  // namespace trapeze
