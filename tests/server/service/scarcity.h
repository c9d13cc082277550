// Shortage of memory and threads: in a program that links this file, allocations and thread starts
// fail on demand, as on an exhausted machine.
#pragma once

namespace trapeze::testing {

/// While it exists, grants `count` requests, over all threads together, and then refuses.
class Scarcity {
 public:
  enum class Of { large_arrays, threads };

  Scarcity(Of what, int count);
  ~Scarcity();
  Scarcity(const Scarcity&) = delete;
  Scarcity& operator=(const Scarcity&) = delete;

 private:
  const Of what_;
};

}  // namespace trapeze::testing
