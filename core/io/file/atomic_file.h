// Files that are written completely or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/io/file/unfinished.h"

namespace trapeze {

/// A file that is written piece by piece. It is new, read-only, and beside `path`, see
/// unfinished.h; until it is finished `path` stays as it was. All methods throw std::runtime_error
/// that names the path and says why. One thread at a time.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// After what was written before.
  void write(std::span<const std::byte> bytes);
  /// Over what was written at that place; it does not reach beyond the end.
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Waits until all is on the disk, and gives it the name `path`, in place of a file that had it.
  void finish();

 private:
  const std::string path_;
  const Unfinished temporary_;
  int descriptor_ = -1;
};

/// Waits until the file or folder is on the disk, and gives it the name `path`, in place of a file
/// or an empty folder that had it. Throws std::runtime_error that names the path and says why.
void give_name_durably(const Unfinished& unfinished, const std::string& path);

/// Writes the pieces one after another into a new, read-only file beside `path`, waits until they
/// are on the disk, and only then gives it the name `path`, in place of a file that had it.
/// Whatever happens before, `path` stays as it was and nothing is left beside it (see
/// unfinished.h). Throws
/// std::runtime_error that names the path and says why.
void write_atomically(const std::string& path,
                      const std::vector<std::span<const std::byte>>& pieces);

}  // namespace trapeze
