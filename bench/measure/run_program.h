// The main function of benchmarks.
#pragma once

#include <cstdio>
#include <exception>

namespace trapeze {

/// Returns the exit status of run(argc, argv); 1 if it throws, with a message under the program's
/// name.
inline int run_program(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace trapeze
