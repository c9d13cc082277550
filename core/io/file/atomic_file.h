// Files that are written completely or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/io/file/unfinished.h"

namespace trapeze {

/// A new, read-only file beside `path` that is written piece by piece, see unfinished.h. Until it
/// is finished, `path` stays unchanged. All methods throw std::runtime_error that names the path
/// and the reason. One thread at a time.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends to the bytes written before.
  void write(std::span<const std::byte> bytes);
  /// Overwrites bytes already written at that place; must not extend beyond the end.
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Waits until everything is on disk and renames the file to `path`, replacing a file of that
  /// name.
  void finish();

 private:
  const std::string path_;
  const Unfinished temporary_;
  int descriptor_ = -1;
};

/// Waits until the file or folder is on disk and renames it to `path`, replacing a file or an empty
/// folder of that name. Throws std::runtime_error that names the path and the reason.
void give_name_durably(const Unfinished& unfinished, const std::string& path);

/// Why no SQLite database may get that name, in words; empty if it may. A log or a journal that
/// belongs to another database of that name, which a program has open or did not close, would be
/// applied to the new one and damage it.
std::string problem_with_database_at(const std::string& path);

/// Writes the pieces one after another into a new, read-only file beside `path`, waits until they
/// are on disk, and only then renames it to `path`, replacing a file of that name. If anything
/// fails before, `path` stays unchanged and nothing is left beside it (see unfinished.h). Throws
/// std::runtime_error that names the path and the reason.
void write_atomically(const std::string& path,
                      const std::vector<std::span<const std::byte>>& pieces);

}  // namespace trapeze
