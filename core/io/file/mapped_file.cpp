#include "core/io/file/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace trapeze {
namespace {

[[noreturn]] void fail_to_map(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}

[[noreturn]] void fail_to_map(const std::string& path, const std::string& what, int error) {
  const std::string words = path + ": " + what + ": " + std::strerror(error);
  const bool is_shortage = error == EMFILE || error == ENFILE || error == ENOMEM || error == EAGAIN;
  if (is_shortage) throw MappingShortage(words);
  throw std::runtime_error(words);
}

int open_or_throw(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) fail_to_map(path, "cannot be read", errno);
  return file;
}

std::int64_t modified_of(const struct stat& status) {
  return std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
}

}  // namespace

/// Registers mappings. Reading a part that a file no longer has raises SIGBUS. If that happens
/// within a registered mapping, the page is replaced by zeros and the reader continues. The page
/// stays replaced, even if the file gets its bytes back.
class MappingGuard {
 public:
  /// Returns what tells whether a page was replaced; null if there is no room for another mapping.
  static const std::atomic<bool>* add(std::span<const std::byte> bytes) {
    static std::once_flag once;
    std::call_once(once, catch_signal);
    for (Slot& slot : slots()) {
      std::uintptr_t none = 0;
      if (!slot.begin.compare_exchange_strong(none, kTaken)) continue;
      slot.end = begin_of(bytes) + bytes.size();
      slot.is_torn = false;
      slot.begin = begin_of(bytes);
      return &slot.is_torn;
    }
    return nullptr;  // more files than slots: the others are mapped without a guard
  }
  static void remove(std::span<const std::byte> bytes) {
    for (Slot& slot : slots()) {
      std::uintptr_t same = begin_of(bytes);
      if (slot.begin.compare_exchange_strong(same, 0)) return;
    }
  }

 private:
  static constexpr std::size_t kMostFiles = 4096;
  /// The addresses of a mapping instead of the file object: another thread may be destroying that
  /// while the handler searches for its own.
  struct Slot {
    std::atomic<std::uintptr_t> begin = 0;  // 0: free
    std::atomic<std::uintptr_t> end = 0;
    std::atomic<bool> is_torn = false;
  };
  static constexpr std::uintptr_t kTaken = 1;  // begin of a slot whose end is being written
  using Slots = std::array<Slot, kMostFiles>;
  static_assert(std::atomic<std::uintptr_t>::is_always_lock_free &&
                std::atomic<bool>::is_always_lock_free);

  static Slots& slots() {
    static Slots slots{};
    return slots;
  }
  static std::uintptr_t begin_of(std::span<const std::byte> bytes) {
    return reinterpret_cast<std::uintptr_t>(bytes.data());
  }

  static void catch_signal() {
    slots();  // created before the handler may need them, here and below
    page_size();
    struct sigaction action {};
    action.sa_sigaction = on_signal;
    action.sa_flags = SA_SIGINFO;
    sigemptyset(&action.sa_mask);
    sigaction(SIGBUS, &action, nullptr);
  }

  static std::size_t page_size() {
    static const auto size = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    return size;
  }

  // Makes only system calls. A file that is being read is mapped, so it stays in its slot.
  static void on_signal(int, siginfo_t* info, void*) {
    const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    for (Slot& slot : slots()) {
      const std::uintptr_t begin = slot.begin;
      const std::uintptr_t end = slot.end;
      if (begin <= kTaken || address < begin || address >= end || slot.begin != begin) continue;
      auto* const page = static_cast<std::byte*>(info->si_addr) - address % page_size();
      const int error = errno;
      slot.is_torn = true;  // before anybody can read the zeros
      const void* zeros =
          mmap(page, page_size(), PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
      errno = error;
      if (zeros != MAP_FAILED) return;
    }
    // Not in a mapping of ours: the signal is raised again and ends the program as it otherwise
    // would.
    signal(SIGBUS, SIG_DFL);
  }
};

MappedFile::MappedFile(const std::string& path, Pages pages) : file_(open_or_throw(path)) {
  try {
    map(path, pages);
  } catch (...) {
    close(file_);
    throw;
  }
}

void MappedFile::map(const std::string& path, Pages pages) {
  struct stat status {};
  if (fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    fail_to_map(path, "is no regular file");
  }
  modified_ = modified_of(status);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return;
  const int flags = pages == Pages::at_once ? MAP_SHARED | MAP_POPULATE : MAP_SHARED;
  void* memory = mmap(nullptr, size, PROT_READ, flags, file_, 0);
  if (memory == MAP_FAILED) {
    fail_to_map(path, "cannot be mapped", errno);
  }
  bytes_ = {static_cast<const std::byte*>(memory), size};
  is_torn_ = MappingGuard::add(bytes_);
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) {
    MappingGuard::remove(bytes_);
    munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  }
  close(file_);
}

void MappedFile::release_pages() const {
  if (bytes_.empty()) return;
  madvise(const_cast<std::byte*>(bytes_.data()), bytes_.size(), MADV_DONTNEED);
}

// The descriptor refers to the mapped file, whatever its name refers to by now.
bool MappedFile::is_whole() const {
  if (is_torn_ != nullptr && *is_torn_) return false;
  struct stat status {};
  return fstat(file_, &status) == 0 && static_cast<std::size_t>(status.st_size) == bytes_.size() &&
         modified_of(status) == modified_;
}

}  // namespace trapeze
