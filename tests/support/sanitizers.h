// Which sanitizer this build has, and which tests it is not for.
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

}  // namespace sansmesh::test

/// First line of a test that takes long under sanitizers and shows them nothing new: `why` says who runs the same code.
#define SANSMESH_NOT_SANITIZED(why) \
  if (::sansmesh::test::kAddressSanitizer || ::sansmesh::test::kThreadSanitizer) GTEST_SKIP() << why
