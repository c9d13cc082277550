// Files that are written completely or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace trapeze {

/// Writes the pieces one after another into a new, read-only file beside `path`, waits until they
/// are on the disk, and only then gives it the name `path`, in place of a file that had it.
/// Whatever happens before, `path` stays as it was and nothing is left beside it (see
/// unfinished.h). Throws
/// std::runtime_error that names the path and says why.
void write_atomically(const std::string& path,
                      const std::vector<std::span<const std::byte>>& pieces);

}  // namespace trapeze
