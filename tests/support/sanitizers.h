// Which sanitizer this build has, and which tests are not for it or not for every set of instructions.
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

/// Whether the tests run once more, on another set of instructions than the best one (main.cpp).
inline bool on_other_simd = false;

}  // namespace sansmesh::test

/// First line of a test that takes long under sanitizers and shows them nothing new: `why` says who runs the same code.
#define SANSMESH_NOT_SANITIZED(why) \
  if (::sansmesh::test::kAddressSanitizer || ::sansmesh::test::kThreadSanitizer) GTEST_SKIP() << why

/// The same for what shows nothing new on other sets of instructions either: tests/kernels says that they give the same
/// bits.
#define SANSMESH_RUNS_ONCE(why) \
  SANSMESH_NOT_SANITIZED(why);  \
  if (::sansmesh::test::on_other_simd) GTEST_SKIP() << why
