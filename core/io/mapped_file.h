// A file as memory, read-only and shared with every other process that maps it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace trapeze {

/// Must not be cut off or written to while it is mapped; replacing it (by rename) or removing it
/// does no harm. Thread-safety: any number of threads may read.
class MappedFile {
 public:
  /// Throws std::runtime_error that names the path if it is no regular file or cannot be read.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Begins at the border of a page.
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace trapeze
