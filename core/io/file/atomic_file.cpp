#include "core/io/file/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace trapeze {
namespace {

constexpr std::size_t kBytesAtOnce = std::size_t{1} << 30;  // accepted by a single write

[[noreturn]] void fail_to_write(const std::string& path) {
  throw std::runtime_error("cannot write " + path + ": " + std::generic_category().message(errno));
}

/// Makes the name survive a power failure. Not every file system supports this, and the file
/// already exists, so failure is ignored.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path)
    : path_(path),
      temporary_(Unfinished::file_beside(path)),
      // Read-only: writing to a mapped file would change what is being served.
      descriptor_(open(temporary_.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0444)) {
  if (descriptor_ < 0) fail_to_write(path_);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(descriptor_, bytes.data(), std::min(bytes.size(), kBytesAtOnce));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(descriptor_, bytes.data(), std::min(bytes.size(), kBytesAtOnce),
                                   static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path_);
    offset += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void AtomicFile::finish() {
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (close(descriptor) != 0) fail_to_write(path_);
  give_name_durably(temporary_, path_);
}

void give_name_durably(const Unfinished& unfinished, const std::string& path) {
  const int descriptor = open(unfinished.path().c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_to_write(path);
  struct stat status {};
  const bool is_folder = fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode);
  const int result = is_folder ? syncfs(descriptor) : fsync(descriptor);
  const int reason = errno;
  close(descriptor);
  errno = reason;
  if (result != 0) fail_to_write(path);
  std::error_code error;
  Unfinished::give_name(unfinished.path(), path, error);
  if (error) throw std::runtime_error("cannot write " + path + ": " + error.message());
  sync_folder_of(path);
}

std::string problem_with_database_at(const std::string& path) {
  for (const char* ending : {"-wal", "-journal"}) {
    const std::string log = path + ending;
    std::error_code error;
    if (!std::filesystem::exists(log, error)) continue;
    return "another program has it open, or ended without closing it, and left " + log +
           ", which would damage the new file; close that program, or remove " + log;
  }
  return {};
}

void write_atomically(const std::string& path,
                      const std::vector<std::span<const std::byte>>& pieces) {
  AtomicFile file(path);
  for (const std::span<const std::byte> piece : pieces) file.write(piece);
  file.finish();
}

}  // namespace trapeze
