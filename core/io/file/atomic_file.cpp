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

#include "core/io/file/unfinished.h"

namespace trapeze {
namespace {

constexpr std::size_t kBytesAtOnce = std::size_t{1} << 30;  // what one write takes for sure

[[noreturn]] void fail(const std::string& path) {
  throw std::runtime_error("cannot write " + path + ": " + std::generic_category().message(errno));
}

/// A file under a name of its own, gone at the end unless it was given its final one.
class NewFile {
 public:
  explicit NewFile(const std::string& path)
      : path_(path),
        temporary_(Unfinished::file_beside(path)),
        // Read-only: to write into a file that is mapped would change what is being served.
        descriptor_(
            open(temporary_.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0444)) {
    if (descriptor_ < 0) fail(path_);
  }
  ~NewFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t written =
          ::write(descriptor_, bytes.data(), std::min(bytes.size(), kBytesAtOnce));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  void give_name() {
    if (fsync(descriptor_) != 0) fail(path_);
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (close(descriptor) != 0) fail(path_);
    std::error_code error;
    Unfinished::give_name(temporary_.path(), path_, error);
    if (error) throw std::runtime_error("cannot write " + path_ + ": " + error.message());
  }

 private:
  const std::string path_;
  const Unfinished temporary_;
  int descriptor_ = -1;
};

/// So that the name outlives a power cut, too. Not every file system can, and the file is there
/// already: failing is no failure.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace

void write_atomically(const std::string& path,
                      const std::vector<std::span<const std::byte>>& pieces) {
  NewFile file(path);
  for (const std::span<const std::byte> piece : pieces) file.write(piece);
  file.give_name();
  sync_folder_of(path);
}

}  // namespace trapeze
