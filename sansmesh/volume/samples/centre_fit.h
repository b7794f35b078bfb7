// Values of local polynomials at their centre as linear combinations of the samples.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The polynomial of degree 0, 1 or 2 that minimises Σ w_j (f_j − p(u_j))² has the value Σ l_j f_j at u = 0, whose
/// coefficients l_j this finds for any values, so that their variance is known. Polynomials that the samples do not
/// determine are omitted. One object per thread; it reuses memory.
class CentreFit {
 public:
  static constexpr int kMaxDegree = 2;

  /// Sets the positions, in coordinates of order 1.
  void place(std::span<const Vec3> u);
  /// Sets the weights of the first `weights.size()` positions, for fits up to this degree.
  void weigh(std::span<const double> weights, int max_degree = kMaxDegree);
  /// Coefficients of these positions; all 0 if all weights are 0.
  std::span<const double> coefficients(int degree);
  /// Gradient of the polynomial of degree 1 with these values, in the same coordinates.
  Vec3 slope(std::span<const double> f) const;

 private:
  static constexpr std::size_t kTerms = 10;

  std::vector<double> basis_[kTerms], weighted_;
  std::vector<double> weights_, result_;
  double moments_[kTerms][kTerms]{};
};

}  // namespace sansmesh::inline v1
