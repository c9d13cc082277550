// The viewer as it was built into the program, with what its files are compressed to.
//
// Thread-safety: any thread.
#pragma once

#include <span>
#include <string_view>

namespace trapeze {

struct BuiltInFile {
  std::string_view path;  // "/index.html"
  std::string_view bytes;
  std::string_view gzip;  // empty where it would not be smaller, as the next
  std::string_view brotli;
};

/// None if the viewer was left out of the build (TRAPEZE_VIEWER).
std::span<const BuiltInFile> viewer_files();

}  // namespace trapeze
