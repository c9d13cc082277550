#include "tests/server/service/scarcity.h"

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

constexpr int kAll = std::numeric_limits<int>::max();
constexpr std::size_t kLarge = std::size_t{64} << 10;  // bytes; no library requests so many

std::atomic<int> large_arrays_left = kAll;
std::atomic<int> threads_left = kAll;

bool may_have(std::atomic<int>& left) {
  return left == kAll || left-- > 0;
}

std::atomic<int>& left_of(trapeze::testing::Scarcity::Of what) {
  return what == trapeze::testing::Scarcity::Of::threads ? threads_left : large_arrays_left;
}

}  // namespace

void* operator new(std::size_t bytes) {
  if (bytes >= kLarge && !may_have(large_arrays_left)) throw std::bad_alloc();
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*run)(void*), void* argument) {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  if (!may_have(threads_left)) return EAGAIN;
  return create(thread, attributes, run, argument);
}

namespace trapeze::testing {

Scarcity::Scarcity(Of what, int count) : what_(what) {
  left_of(what_) = count;
}

Scarcity::~Scarcity() {
  left_of(what_) = kAll;
}

}  // namespace trapeze::testing
