// The viewer files built into the binary, with their compressed forms.
//
// Thread-safety: any thread.
#pragma once

#include <span>
#include <string_view>

namespace trapeze {

struct BuiltInFile {
  std::string_view path;  // "/index.html"
  std::string_view bytes;
  std::string_view gzip;  // empty if it would not be smaller; the same below
  std::string_view brotli;
};

/// Empty if the viewer was left out of the build (TRAPEZE_VIEWER).
std::span<const BuiltInFile> viewer_files();

}  // namespace trapeze
