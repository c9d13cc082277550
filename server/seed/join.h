// Joins seeded tiles into an archive.
#pragma once

#include <string>

#include "server/seed/seed_log.h"

namespace trapeze {

struct JoinOptions {
  bool is_sparse = false;  // leaves out tiles that show nothing; in a folder they are always left
                           // out
};

/// Throws std::runtime_error if the archive's name is taken by something that is not replaced,
/// which is a non-empty folder, or if there is no folder to put it in.
void check_place_of_archive(const std::string& path);

/// Writes the archive. Its bytes depend only on what was seeded, not on how that was divided among
/// logs. Throws std::runtime_error that names the archive if it cannot be written; in that case an
/// existing archive is left unchanged.
void join_into_archive(const SeedLogs& logs, const std::string& path, const JoinOptions& options);

}  // namespace trapeze
