// An array in an unnamed file, so that the system can page it out when memory is short, and nothing
// is left behind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

namespace trapeze {

/// Memory in a file in the folder of `path`, initially zero. Disk space is allocated immediately:
/// if there is not enough, the constructor throws std::runtime_error that names `path`.
class ScratchFile {
 public:
  ScratchFile(const std::string& path, std::size_t bytes);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  std::span<std::byte> bytes() { return bytes_; }

 private:
  std::span<std::byte> bytes_;
};

/// An array of that many items, initially zero.
template <typename T>
class ScratchArray {
 public:
  static_assert(std::is_trivially_copyable_v<T>);

  ScratchArray(const std::string& path, std::uint64_t count)
      : file_(path, count * sizeof(T)), items_(reinterpret_cast<T*>(file_.bytes().data()), count) {}

  std::span<T> items() { return items_; }
  T& operator[](std::size_t i) { return items_[i]; }

 private:
  ScratchFile file_;
  std::span<T> items_;
};

}  // namespace trapeze
