// A read-only, memory-mapped file, shared with every other process that maps it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace trapeze {

/// A file cannot be opened or mapped at the moment, as descriptors or memory are short. That
/// passes.
class MappingShortage : public std::runtime_error {
  using runtime_error::runtime_error;
};

/// The file must not be written to while it is mapped; replacing it (by rename) or removing it is
/// harmless. If it is written to nevertheless, or cannot be read from its disk, is_whole() is
/// false, and bytes that do not exist read as zeros. Thread-safety: any number of threads may read.
class MappedFile {
 public:
  /// When pages become resident.
  enum class Pages {
    at_once,    // immediately: all of it is about to be read
    as_needed,  // each page when it is read
  };

  /// Throws std::runtime_error that names the path if it is not a regular file or cannot be read:
  /// MappingShortage if only at the moment.
  explicit MappedFile(const std::string& path, Pages pages = Pages::at_once);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// Begins at a page boundary.
  std::span<const std::byte> bytes() const { return bytes_; }
  /// Whether the file still has its original size and modification time, and all bytes read so far
  /// were those of the file.
  bool is_whole() const;
  /// Allows the system to drop resident pages until they are read again. Other threads may read
  /// meanwhile.
  void release_pages() const;

 private:
  void map(const std::string& path, Pages pages);

  int file_;
  std::int64_t modified_ = 0;  // nanoseconds since 1970
  std::span<const std::byte> bytes_;
  const std::atomic<bool>* is_torn_ = nullptr;  // null if the mapping is not guarded
};

}  // namespace trapeze
