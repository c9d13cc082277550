// Creates the archive writer for a file name.
#pragma once

#include <memory>
#include <string>

#include "server/seed/archive.h"

namespace trapeze {

/// Starts the archive. Throws as ArchiveWriter does.
std::unique_ptr<ArchiveWriter> write_archive(const std::string& path,
                                             const ArchiveDescription& description,
                                             const ArchiveSize& size);

}  // namespace trapeze
