// Makes the archive of what has been seeded.
#pragma once

#include <string>

#include "server/seed/seed_log.h"

namespace trapeze {

struct JoinOptions {
  bool is_sparse = false;  // tiles in which nothing is seen are left out, as they always are of a
                           // folder
};

/// Throws std::runtime_error if there is something of the name of the archive that is not replaced:
/// a folder that is not empty. Or if there is no folder for it.
void check_place_of_archive(const std::string& path);

/// Writes the archive, whose bytes depend on what was seeded only, and not on how that was divided
/// among logs. Throws std::runtime_error that names the archive if it cannot be written: then there
/// is what there was before.
void join_into_archive(const SeedLogs& logs, const std::string& path, const JoinOptions& options);

}  // namespace trapeze
