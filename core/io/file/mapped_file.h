// A file as memory, read-only and shared with every other process that maps it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace trapeze {

/// Must not be written to while it is mapped; replacing it (by rename) or removing it does no harm.
/// If it is truncated nevertheless, the missing bytes read as zeros, and is_whole() is false.
/// Thread-safety: any number of threads may read.
class MappedFile {
 public:
  /// Throws std::runtime_error that names the path if it is no regular file or cannot be read.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Begins at a page boundary.
  std::span<const std::byte> bytes() const { return bytes_; }
  /// Whether the file is still as long as it was.
  bool is_whole() const;

 private:
  friend class MappingGuard;

  void map(const std::string& path);

  int file_;
  std::span<const std::byte> bytes_;
};

}  // namespace trapeze
