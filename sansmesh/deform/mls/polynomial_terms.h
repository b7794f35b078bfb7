// Polynomials of nonlinear deformations, without the constant term.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

enum class PolynomialSpace : std::uint8_t {
  linear,
  quadratic,
  harmonic_quadratic,  ///< linear terms and quadratic ones whose Laplacian is 0
  cubic,
  harmonic_cubic,  ///< quadratic terms and cubic ones whose Laplacian is 0
};

constexpr std::size_t kMostMonomials = 19;

/// Monomial j + 3 is this variable times this monomial; the first three are x, y, z.
struct MonomialStep {
  std::uint8_t variable, monomial;
};
constexpr std::array<MonomialStep, kMostMonomials - 3> kMonomialSteps{{{0, 0},
                                                                       {1, 0},
                                                                       {2, 0},
                                                                       {1, 1},
                                                                       {2, 1},
                                                                       {2, 2},  // xx xy xz yy yz zz
                                                                       {0, 3},
                                                                       {1, 3},
                                                                       {2, 3},
                                                                       {1, 4},
                                                                       {2, 4},
                                                                       {2, 5},
                                                                       {1, 6},
                                                                       {2, 6},
                                                                       {2, 7},
                                                                       {2, 8}}};  // xxx xxy xxz xyy xyz xzz yyy …

/// Σ factor · monomial.
struct PolynomialTerm {
  std::uint8_t parts;
  std::array<std::uint8_t, 3> monomial;
  std::array<double, 3> factor;
};

/// The polynomials that span a space: each is a monomial, or a sum of up to three.
struct PolynomialTerms {
  std::size_t monomials = 0;  ///< number of monomials needed
  std::size_t count = 0;
  std::array<PolynomialTerm, kMostMonomials> terms{};
};

constexpr PolynomialTerms polynomial_terms(PolynomialSpace space) {
  PolynomialTerms t;
  const auto monomials_up_to = [&t](std::size_t n) {
    for (std::size_t j = 0; j < n; ++j) t.terms[t.count++] = {1, {static_cast<std::uint8_t>(j), 0, 0}, {1, 0, 0}};
  };
  const auto add = [&t](PolynomialTerm term) { t.terms[t.count++] = term; };
  switch (space) {
    case PolynomialSpace::linear:
      t.monomials = 3, monomials_up_to(3);
      break;
    case PolynomialSpace::quadratic:
      t.monomials = 9, monomials_up_to(9);
      break;
    case PolynomialSpace::harmonic_quadratic:
      t.monomials = 9, monomials_up_to(3);
      for (const std::size_t mixed : {4, 5, 7}) add({1, {static_cast<std::uint8_t>(mixed), 0, 0}, {1, 0, 0}});
      add({2, {3, 6, 0}, {1, -1, 0}});   // xx − yy
      add({3, {8, 3, 6}, {2, -1, -1}});  // 2zz − xx − yy
      break;
    case PolynomialSpace::cubic:
      t.monomials = 19, monomials_up_to(19);
      break;
    case PolynomialSpace::harmonic_cubic:
      t.monomials = 19, monomials_up_to(9);
      add({1, {13, 0, 0}, {1, 0, 0}});      // xyz
      add({2, {9, 12, 0}, {1, -3, 0}});     // x (xx − 3yy)
      add({2, {10, 15, 0}, {3, -1, 0}});    // y (3xx − yy)
      add({2, {11, 16, 0}, {1, -1, 0}});    // z (xx − yy)
      add({3, {18, 11, 16}, {2, -3, -3}});  // z (2zz − 3xx − 3yy)
      add({3, {14, 9, 12}, {4, -1, -1}});   // x (4zz − xx − yy)
      add({3, {17, 10, 15}, {4, -1, -1}});  // y (4zz − xx − yy)
      break;
  }
  return t;
}

/// Values of all terms at v and, if `slopes` is not null, their gradients.
inline void evaluate_terms(const PolynomialTerms& t, const Vec3& v, double* values, Vec3* slopes) {
  std::array<double, kMostMonomials> m{v.x, v.y, v.z};
  std::array<Vec3, kMostMonomials> g{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (std::size_t j = 3; j < t.monomials; ++j) {
    const MonomialStep s = kMonomialSteps[j - 3];
    m[j] = v[s.variable] * m[s.monomial];
    g[j] = g[s.variable] * m[s.monomial] + g[s.monomial] * v[s.variable];
  }
  for (std::size_t j = 0; j < t.count; ++j) {
    const PolynomialTerm& term = t.terms[j];
    values[j] = 0;
    Vec3 slope;
    for (std::size_t k = 0; k < term.parts; ++k) {
      values[j] += term.factor[k] * m[term.monomial[k]];
      slope += g[term.monomial[k]] * term.factor[k];
    }
    if (slopes) slopes[j] = slope;
  }
}

}  // namespace sansmesh::inline v1::detail
