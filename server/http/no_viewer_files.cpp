// Replaces the source that web/embed.mjs generates, in builds without the viewer.
#include "server/http/viewer_files.h"

namespace trapeze {

std::span<const BuiltInFile> viewer_files() {
  return {};
}

}  // namespace trapeze
