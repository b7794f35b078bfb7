// Least-squares fits of a bivariate polynomial to the samples of one support, all degrees at once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/partition/local_function.h"

namespace sansmesh {

/// Samples of one support in its local frame, divided by the scale; a structure of arrays that is reused from fit to
/// fit.
struct LocalSamples {
  std::vector<float> u, v, w, weight;
  std::size_t size() const { return u.size(); }
  void clear() { u.clear(), v.clear(), w.clear(), weight.clear(); }
};

/// Result of fit_all_degrees: entry d belongs to degree d.
struct DegreeFits {
  int highest = -1;                                  ///< highest degree fitted; -1: not even a constant
  double weight_sum = 0;                             ///< Σ w_i
  double effective_count = 0;                        ///< (Σ w_i)² / Σ w_i²
  std::array<double, kMaxDegree + 1> mean_square{};  ///< Σ w_i r_i² / Σ w_i, in units of scale²
  std::array<double, 15> y{};                        ///< coefficients in the orthonormal basis
  std::array<std::array<double, 15>, 15> l{};        ///< rows of the basis change (lower triangular)
};

/// Weighted least squares of w over (u, v) for every degree 0..max_degree. Degrees that the samples cannot determine
/// (fewer than 2 samples a basis function, or a basis function that vanishes on them) are left out, and all above them.
DegreeFits fit_all_degrees(const LocalSamples& samples, int max_degree);

/// Monomial coefficients of the fit of one degree (<= fits.highest).
std::array<float, 15> monomial_coefficients(const DegreeFits& fits, int degree);

}  // namespace sansmesh
