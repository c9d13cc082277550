// The way in and out of a benchmark.
#pragma once

#include <cstdio>
#include <exception>

namespace trapeze {

/// The exit status of run(argc, argv); 1 if it throws, which is told under the program's name.
inline int run_program(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace trapeze
