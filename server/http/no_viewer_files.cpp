// In the place of the source that web/embed.mjs makes, for a build without the viewer.
#include "server/http/viewer_files.h"

namespace trapeze {

std::span<const BuiltInFile> viewer_files() {
  return {};
}

}  // namespace trapeze
