#include "core/io/file/mapped_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace trapeze {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}

int open_or_throw(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) fail(path, std::string("cannot be read: ") + std::strerror(errno));
  return file;
}

}  // namespace

/// Knows what is mapped. Reading what a file has no more raises SIGBUS; where that happens within a
/// mapping, the page is replaced by zeros and the reader goes on.
class MappingGuard {
 public:
  static void add(const MappedFile& file) {
    static std::once_flag once;
    std::call_once(once, catch_signal);
    for (auto& slot : files()) {
      const MappedFile* none = nullptr;
      if (slot.compare_exchange_strong(none, &file)) return;
    }
    // More files than slots: the rest is mapped without a guard.
  }
  static void remove(const MappedFile& file) {
    for (auto& slot : files()) {
      const MappedFile* same = &file;
      if (slot.compare_exchange_strong(same, nullptr)) return;
    }
  }

 private:
  static constexpr std::size_t kMostFiles = 1024;
  using Files = std::array<std::atomic<const MappedFile*>, kMostFiles>;
  static_assert(std::atomic<const MappedFile*>::is_always_lock_free);

  static Files& files() {
    static Files files{};
    return files;
  }

  static void catch_signal() {
    files();  // made before the handler may ask for it
    page_size() = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    struct sigaction action {};
    action.sa_sigaction = on_signal;
    action.sa_flags = SA_SIGINFO;
    sigemptyset(&action.sa_mask);
    sigaction(SIGBUS, &action, nullptr);
  }

  static std::size_t& page_size() {
    static std::size_t size = 0;
    return size;
  }

  // Calls nothing but system calls. A file that is read is mapped, so it stays in its slot.
  static void on_signal(int, siginfo_t* info, void*) {
    const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    for (const auto& slot : files()) {
      const MappedFile* file = slot.load();
      if (file == nullptr) continue;
      const auto begin = reinterpret_cast<std::uintptr_t>(file->bytes_.data());
      if (address < begin || address >= begin + file->bytes_.size()) continue;
      void* page = reinterpret_cast<void*>(address & ~(page_size() - 1));
      const int error = errno;
      const void* zeros =
          mmap(page, page_size(), PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
      errno = error;
      if (zeros != MAP_FAILED) return;
    }
    // Somebody else's: it strikes again, and ends the program as it would have.
    signal(SIGBUS, SIG_DFL);
  }
};

MappedFile::MappedFile(const std::string& path) : file_(open_or_throw(path)) {
  try {
    map(path);
  } catch (...) {
    close(file_);
    throw;
  }
}

void MappedFile::map(const std::string& path) {
  struct stat status {};
  if (fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) fail(path, "is no regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return;
  // Its pages are taken in at once: all of it is about to be read.
  void* memory = mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_POPULATE, file_, 0);
  if (memory == MAP_FAILED) fail(path, std::string("cannot be mapped: ") + std::strerror(errno));
  bytes_ = {static_cast<const std::byte*>(memory), size};
  MappingGuard::add(*this);
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) {
    MappingGuard::remove(*this);
    munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  }
  close(file_);
}

bool MappedFile::is_whole() const {
  struct stat status {};
  return fstat(file_, &status) == 0 && static_cast<std::size_t>(status.st_size) >= bytes_.size();
}

}  // namespace trapeze
