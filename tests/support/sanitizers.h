// Sanitizer of this build, and tests to skip with sanitizers or on other instruction sets.
#pragma once

#include <gtest/gtest.h>

namespace sansmesh::test {

#if defined(__SANITIZE_THREAD__)
inline constexpr bool kThreadSanitizer = true;
#elif defined(__has_feature)
inline constexpr bool kThreadSanitizer = __has_feature(thread_sanitizer);
#else
inline constexpr bool kThreadSanitizer = false;
#endif

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
inline constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool kAddressSanitizer = false;
#endif

/// Whether the tests run again on another instruction set than the best one (main.cpp).
inline bool on_other_simd = false;

}  // namespace sansmesh::test

/// First line of a test that is slow under sanitizers and covers no additional code: `why` names the test of the same
/// code.
#define SANSMESH_NOT_SANITIZED(why) \
  if (::sansmesh::test::kAddressSanitizer || ::sansmesh::test::kThreadSanitizer) GTEST_SKIP() << why

/// Same, also for other instruction sets: tests/kernels checks that they give identical bits.
#define SANSMESH_RUNS_ONCE(why) \
  SANSMESH_NOT_SANITIZED(why);  \
  if (::sansmesh::test::on_other_simd) GTEST_SKIP() << why
