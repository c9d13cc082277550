// A file as memory, read-only and shared with every other process that maps it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace trapeze {

/// Must not be written to while it is mapped; replacing it (by rename) or removing it does no harm.
/// If it is written to nevertheless, is_whole() is false; bytes that it has no more read as zeros.
/// Thread-safety: any number of threads may read.
class MappedFile {
 public:
  /// When its pages become resident.
  enum class Pages {
    at_once,    // all of it is about to be read
    as_needed,  // each when it is read
  };

  /// Throws std::runtime_error that names the path if it is no regular file or cannot be read.
  explicit MappedFile(const std::string& path, Pages pages = Pages::at_once);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Begins at a page boundary.
  std::span<const std::byte> bytes() const { return bytes_; }
  /// Whether the file still has the size and the time of its last change that it had.
  bool is_whole() const;
  /// Its pages need not be resident until they are read again. Any thread may read meanwhile.
  void release_pages() const;

 private:
  void map(const std::string& path, Pages pages);

  int file_;
  std::int64_t modified_ = 0;  // nanoseconds since 1970
  std::span<const std::byte> bytes_;
};

}  // namespace trapeze
