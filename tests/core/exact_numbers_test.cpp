// Numbers of exact predicates: error bounds, residues, integers times powers of two.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/core/bounded.h"
#include "sansmesh/core/dyadic.h"
#include "sansmesh/core/residue.h"

namespace sansmesh::test {
namespace {

std::vector<double> awkward_numbers() {
  std::mt19937_64 random(5);
  std::vector<double> x{0, 1, -1, 0.1, -1e-30, 1e30, 5e-324, -2.2250738585072014e-308, 3, 1.0 / 3};
  for (int i = 0; i < 40; ++i)
    x.push_back(
        std::ldexp(static_cast<double>(static_cast<std::int64_t>(random())), static_cast<int>(random() % 200) - 160));
  return x;
}

TEST(ExactNumbers, IdentitiesHold) {
  const std::vector<double> x = awkward_numbers();
  for (std::size_t i = 0; i + 2 < x.size(); ++i) {
    const Dyadic a = x[i], b = x[i + 1], c = x[i + 2];
    EXPECT_EQ(((a + b) * c - a * c - b * c).sign(), 0);
    EXPECT_EQ(((a - b) * (a + b) - a * a + b * b).sign(), 0);
    EXPECT_EQ((a - b).sign(), x[i] > x[i + 1] ? 1 : x[i] < x[i + 1] ? -1 : 0);
    const Residue p = x[i], q = x[i + 1], r = x[i + 2];
    EXPECT_TRUE(((p + q) * r - p * r - q * r).zero());
    EXPECT_TRUE(((p - q) * (p + q) - p * p + q * q).zero());
    if (x[i] != 0) EXPECT_EQ(q / p * p, q);
    EXPECT_EQ((p - q).zero(), x[i] == x[i + 1]);
    if (std::abs(x[i]) > 1e-300) EXPECT_EQ(Residue(x[i] * 0.5), p * Residue(0.5));
  }
}

TEST(ExactNumbers, TinyDifferencesHaveASign) {
  // (1 + 2^-52)² − (1 + 2^-51) is 2^-104.
  const double e = 0x1p-52;
  const Dyadic d = Dyadic(1 + e) * Dyadic(1 + e) - Dyadic(1 + 2 * e);
  EXPECT_EQ(d.sign(), 1);
  EXPECT_EQ(Dyadic::ratio(d, Dyadic(1)), 0x1p-104);
  const Bounded b = Bounded(1 + e) * Bounded(1 + e) - Bounded(1 + 2 * e);
  EXPECT_EQ(b.sign(), 0);
  EXPECT_GE(b.error, 0x1p-104);
  EXPECT_NEAR(Dyadic::ratio(Dyadic(1e30), Dyadic(3)), 1e30 / 3, 1e15);
}

TEST(ExactNumbers, BoundsContainTheExactValue) {
  const std::vector<double> x = awkward_numbers();
  for (std::size_t i = 0; i + 3 < x.size(); ++i) {
    if (std::abs(x[i]) < 1e-100) continue;
    const Bounded b = (Bounded(x[i]) * Bounded(x[i + 1]) - Bounded(x[i + 2])) * Bounded(x[i + 3]);
    const Dyadic exact = (Dyadic(x[i]) * Dyadic(x[i + 1]) - Dyadic(x[i + 2])) * Dyadic(x[i + 3]);
    EXPECT_GE((exact - Dyadic(b.value) + Dyadic(b.error)).sign(), 0);
    EXPECT_LE((exact - Dyadic(b.value) - Dyadic(b.error)).sign(), 0);
    const Bounded q = b / Bounded(x[i]);
    EXPECT_GE((exact - Dyadic(x[i]) * (Dyadic(q.value) - Dyadic(std::copysign(q.error, x[i])))).sign(), 0);
    EXPECT_LE((exact - Dyadic(x[i]) * (Dyadic(q.value) + Dyadic(std::copysign(q.error, x[i])))).sign(), 0);
  }
  EXPECT_TRUE(std::isinf((Bounded(1) / Bounded(0.5, 1)).error));
}

}  // namespace
}  // namespace sansmesh::test
