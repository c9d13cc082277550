// Whether a test is built with sanitizers, under which its times say nothing of the program, and
// the longest of the tests by random shapes take a part of them.
#pragma once

namespace trapeze::testing {

// g++ says so by macros, clang when asked.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSanitized = true;
#elif defined(__has_feature)
inline constexpr bool kIsSanitized =
    __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool kIsSanitized = false;
#endif

}  // namespace trapeze::testing
