// The archive that a name stands for.
#pragma once

#include <memory>
#include <string>

#include "server/seed/archive.h"

namespace trapeze {

/// Begins the archive. Throws as ArchiveWriter does.
std::unique_ptr<ArchiveWriter> write_archive(const std::string& path,
                                             const ArchiveDescription& description,
                                             const ArchiveSize& size);

}  // namespace trapeze
