#include "sansmesh/approximation/polynomial_order.h"

#include <gtest/gtest.h>

#include <string>

namespace sansmesh::inline v1 {
namespace {

template <int D>
std::string row(int degree) {
  const auto& order = PolynomialOrder<D>::get();
  std::string text;
  for (int j = degree > 0 ? monomial_count(D, degree - 1) : 0; j < monomial_count(D, degree); ++j) {
    for (const auto e : order[j].exponent) text += std::to_string(e);
    text += ' ';
  }
  return text;
}

TEST(PolynomialOrder, IsTheTriangleOfThePaper) {
  EXPECT_EQ(row<1>(0), "0 ");
  EXPECT_EQ(row<1>(3), "3 ");
  EXPECT_EQ(row<2>(0), "00 ");
  EXPECT_EQ(row<2>(1), "10 01 ");
  EXPECT_EQ(row<2>(2), "20 11 02 ");
  EXPECT_EQ(row<2>(3), "30 21 12 03 ");
  EXPECT_EQ(row<3>(1), "100 010 001 ");
  EXPECT_EQ(row<3>(2), "200 110 101 020 011 002 ");
  EXPECT_EQ(row<3>(3), "300 210 201 120 111 102 030 021 012 003 ");
}

template <int D>
void check_order() {
  const auto& order = PolynomialOrder<D>::get();
  for (int j = 1; j < PolynomialOrder<D>::kSize; ++j) {
    const auto& step = order[j];
    const int p = step.predecessor;
    ASSERT_LT(p, j);
    EXPECT_EQ(order.product(step.variable, p), j);
    EXPECT_EQ(step.degree, order[p].degree + 1);
    // bartels1985: alpha_jl vanishes for l < j''. The range used is at least as small.
    EXPECT_GE(step.first, order[p].predecessor);
    EXPECT_EQ(static_cast<int>(step.terms.size()), j - step.first);
    for (int l = 0; l + 1 < monomial_count(D, PolynomialOrder<D>::kMaxDegree - 1); ++l)
      EXPECT_LT(order.product(step.variable, l), order.product(step.variable, l + 1));
  }
}

TEST(PolynomialOrder, MultiplicationRespectsTheOrder) {
  check_order<1>();
  check_order<2>();
  check_order<3>();
}

TEST(PolynomialOrder, SavesMostInnerProducts) {
  // Degree 4 in two variables: plain Gram–Schmidt needs 105 inner products.
  const auto& order = PolynomialOrder<2>::get();
  EXPECT_LE(order.slots(14), 50u);
  // Each slot is computed before it is reused.
  for (int j = 0; j < PolynomialOrder<2>::kSize; ++j)
    for (const auto& term : order[j].terms)
      if (term.source == PolynomialOrder<2>::Source::kReused) {
        EXPECT_LT(term.slot, order.slots(j - 1));
      }
}

}  // namespace
}  // namespace sansmesh::inline v1
