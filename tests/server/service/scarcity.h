// Memory and threads that cannot be had: a program that links this fails the calls that ask for
// them when it is told to, as an exhausted machine does.
#pragma once

namespace trapeze::testing {

/// Gives out so many, to all threads together, and then no more, while it lives.
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
