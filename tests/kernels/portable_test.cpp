// Portable arithmetic of kernels on every instruction set, compared with the standard library.
#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/portable_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <hwy/highway.h>

#include "sansmesh/core/portable-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::test {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

// n is a multiple of 16.
void MulAdds(std::size_t n, const float* a, const float* b, const float* c, float* sum, float* rest,
             float* difference) {
  const hn::CappedTag<float, 16> d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, a + i), y = hn::LoadU(d, b + i), z = hn::LoadU(d, c + i);
    hn::StoreU(pn::MulAdd(x, y, z), d, sum + i);
    hn::StoreU(pn::NegMulAdd(x, y, z), d, rest + i);
    hn::StoreU(pn::MulSub(x, y, z), d, difference + i);
  }
}
void ReciprocalSqrts(std::size_t n, const float* x, float* y) {
  const hn::CappedTag<float, 16> d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) hn::StoreU(pn::ReciprocalSqrt(hn::LoadU(d, x + i)), d, y + i);
}
void Exps(std::size_t n, const float* x, float* y) {
  const hn::CappedTag<float, 16> d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) hn::StoreU(pn::Exp(hn::LoadU(d, x + i)), d, y + i);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::test
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <vector>

#include "support/same_bytes.h"
#include "support/simd_targets.h"

namespace sansmesh::test {
HWY_EXPORT(MulAdds);
HWY_EXPORT(ReciprocalSqrts);
HWY_EXPORT(Exps);

namespace {

constexpr std::size_t kMany = 1 << 16;

/// Calls f(name of the target) on every target.
template <class F>
void on_every_target(const F& f) {
  for (const std::int64_t target : simd_targets()) {
    const OnTarget here(target);
    f(hwy::TargetName(target));
  }
}

TEST(Portable, MultiplyAddRoundsOnce) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(-1, 1);
  std::uniform_int_distribution<int> small(-64, 64), far(-160, 120), digits(0, 24);
  std::vector<float> a(kMany), b(kMany), c(kMany);
  for (std::size_t i = 0; i < kMany; ++i) {
    a[i] = u(random), b[i] = u(random), c[i] = u(random);
    switch (i % 6) {
      case 1:  // cancelling sums
        c[i] = -a[i] * b[i];
        break;
      case 2:  // small numbers: exact, and halfway between two floats
        a[i] = static_cast<float>(small(random)), b[i] = static_cast<float>(small(random));
        c[i] = std::ldexp(static_cast<float>(small(random)), digits(random));
        break;
      case 3:  // all magnitudes: overflow, denormal and vanishing sums
        a[i] = std::ldexp(a[i], far(random)), b[i] = std::ldexp(b[i], far(random));
        c[i] = std::ldexp(c[i], far(random));
        break;
      case 4:  // just off halfway, by less than the resolution of a double of that size
        a[i] = 1 + std::ldexp(1.0f, -23), b[i] = std::ldexp(a[i], -24 - digits(random) / 12);
        c[i] = std::ldexp(1.0f + static_cast<float>(i % 64), digits(random));
        break;
      case 5:
        if (i % 5 == 0) a[i] = std::ldexp(1.0f, -24), b[i] = 1, c[i] = 1 + std::ldexp(static_cast<float>(i % 4), -23);
        if (i % 5 == 1) a[i] = 0, b[i] = i % 2 == 0 ? -1.0f : 1.0f, c[i] = i % 4 < 2 ? 0.0f : -0.0f;
        break;
      default:
        break;
    }
  }
  std::vector<float> sum(kMany), rest(kMany), difference(kMany);
  on_every_target([&](const char* name) {
    HWY_DYNAMIC_DISPATCH(MulAdds)(kMany, a.data(), b.data(), c.data(), sum.data(), rest.data(), difference.data());
    std::size_t wrong = 0;
    const auto same = [](float x, float y) {
      return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
    };
    for (std::size_t i = 0; i < kMany; ++i)
      wrong += !same(sum[i], std::fma(a[i], b[i], c[i])) + !same(rest[i], std::fma(-a[i], b[i], c[i])) +
               !same(difference[i], std::fma(a[i], b[i], -c[i]));
    EXPECT_EQ(wrong, 0u) << name;
  });
}

TEST(Portable, ReciprocalSqrtIsAsGoodAsFloatsAreAndTheSameEverywhere) {
  std::vector<float> x(kMany), first, y(kMany);
  std::mt19937 random(2);
  std::uniform_int_distribution<std::uint32_t> bits(0x00800000u, 0x7f7fffffu);
  for (float& v : x) v = std::bit_cast<float>(bits(random));
  on_every_target([&](const char* name) {
    HWY_DYNAMIC_DISPATCH(ReciprocalSqrts)(kMany, x.data(), y.data());
    for (std::size_t i = 0; i < kMany; ++i)
      ASSERT_NEAR(static_cast<double>(y[i]) * std::sqrt(static_cast<double>(x[i])), 1, 9e-8) << name << ' ' << x[i];
    if (first.empty()) first = y;
    EXPECT_TRUE(same_bytes(first, y)) << name;
  });
}

TEST(Portable, ExponentialIsAsGoodAsFloatsAreAndTheSameEverywhere) {
  std::vector<float> x(kMany), first, y(kMany);
  for (std::size_t i = 0; i < kMany; ++i) x[i] = -87 + static_cast<float>(i) * (175.0f / kMany);
  x[0] = -87.001f, x[1] = -1e30f, x[2] = -std::numeric_limits<float>::infinity(), x[3] = 0;
  on_every_target([&](const char* name) {
    HWY_DYNAMIC_DISPATCH(Exps)(kMany, x.data(), y.data());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(y[i], 0) << name;
    EXPECT_EQ(y[3], 1) << name;
    for (std::size_t i = 4; i < kMany; ++i)
      ASSERT_NEAR(static_cast<double>(y[i]) / std::exp(static_cast<double>(x[i])), 1, 8e-8) << name << ' ' << x[i];
    if (first.empty()) first = y;
    EXPECT_TRUE(same_bytes(first, y)) << name;
  });
}

}  // namespace
}  // namespace sansmesh::test
#endif
