// Processor time, which other programs on the machine hardly affect.
#pragma once

#include <ctime>

namespace trapeze::experiment {

/// Milliseconds used by all threads of the program so far.
inline double cpu_clock_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

}  // namespace trapeze::experiment
