// What the kernel reports about this process.
#pragma once

#include <cstddef>

namespace trapeze {

struct ProcessFigures {
  std::size_t resident_bytes = 0;
  std::size_t peak_resident_bytes = 0;  // maximum so far
  std::size_t virtual_bytes = 0;
  std::size_t open_files = 0;
  std::size_t max_files = 0;
  double cpu_seconds = 0;
  double start_time = 0;  // seconds since 1970
};

/// Values that cannot be determined are 0.
ProcessFigures process_figures();

}  // namespace trapeze
