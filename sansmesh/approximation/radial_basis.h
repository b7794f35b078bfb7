// Interpolation with radial basis functions and a polynomial (wendland2004).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1 {

enum class RbfSolver {
  kAutomatic,  ///< kDense up to 1,500 samples; with more, kSparse for Wendland's functions and kLocal for all others
  kDense,      ///< one system of all samples by Cholesky; O(n³), at most kMaxDense samples
  kSparse,     ///< the same for Wendland's functions by preconditioned conjugate gradients
  kLocal       ///< many small systems blended by a partition of unity: O(n) (babuska1997, cavoretto2016)
};

struct RbfOptions {
  RadialFunction function = RadialFunction::kBiharmonic;
  /// Scale of the function, a length > 0. Unset: SampleIndex::spacing() times 2 for multiquadrics, inverse
  /// multiquadrics and Gaussians, times 16, 8 and 4 in one, two and three variables for Wendland's functions (their
  /// support: 32, 200 and 270 samples), times 1 for the others.
  std::optional<double> scale = {};
  /// Degree of the added polynomial, −1 (none) to 2, at least RadialKernel::order() − 1. Unset: 1.
  std::optional<int> degree = {};
  /// λ >= 0, dimensionless, added to the diagonal: 0 interpolates, larger values smooth. |φ(0)| is 1; for the first
  /// three functions it is 0, and λ is in units of φ near the distance of the scale.
  double ridge = 0;
  RbfSolver solver = RbfSolver::kAutomatic;
  /// kLocal: least number of samples per system (if available), 10 to 400.
  std::size_t local_samples = 50;
  /// kSparse: residual relative to the values at which the iteration ends, in (0, 1).
  double tolerance = 1e-10;
  int max_iterations = 2000;
};

/// Statistics of the fit; none of them is an error.
struct RbfReport {
  RbfSolver solver = RbfSolver::kDense;
  double scale = 0;        ///< scale of the function
  std::size_t merged = 0;  ///< samples that coincide with an earlier one; values are averaged
  int dropped_polynomials =
      0;  ///< polynomials that vanish on the samples (coplanar, too few); largest number of all systems
  double added_ridge = 0;   ///< increment of λ that made a system solvable; largest of all systems
  int iterations = 0;       ///< iterations of conjugate gradients
  double residual = 0;      ///< relative residual of conjugate gradients
  std::size_t systems = 1;  ///< kLocal: number of systems
};

/// f(x) = Σ_i c_i φ(‖x − x_i‖) + p(x), Σ_i c_i q(x_i) = 0 for all polynomials q of p's degree. Interpolates (λ = 0) and
/// reproduces polynomials of that degree. Results do not depend on the number of threads.
///
/// kLocal covers the samples' box by balls around the cells of an adaptive subdivision, interpolates the samples of
/// each ball and blends. The result interpolates too, has continuous first derivatives if φ has, and needs linear time,
/// but far from samples it differs from the solution of the full system. Beyond the box by more than a tenth of its
/// size the weights are those of the nearest point of the enlarged box.
template <int D>
class RbfInterpolant {
 public:
  static constexpr std::size_t kMaxDense = 4000;

  /// Throws ArgumentError for options out of range, for kSparse without compact support and for kDense with more than
  /// kMaxDense samples. Throws DataError for no samples, for positions or values that are not finite, for more than
  /// 2^30 pairs of samples within the support, and if conjugate gradients do not reach the tolerance.
  RbfInterpolant(std::span<const Position<D>> positions, std::span<const double> values,
                 const RbfOptions& options = {});

  /// Values, and gradients on request (empty or one per point). NaN at points that are not finite. Throws ArgumentError
  /// for spans of other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<Position<D>> gradients = {}) const;

  const RbfReport& report() const { return report_; }
  const RbfOptions& options() const { return options_; }

 private:
  struct State;
  RbfOptions options_;
  RbfReport report_;
  std::shared_ptr<const State> state_;
};

extern template class RbfInterpolant<1>;
extern template class RbfInterpolant<2>;
extern template class RbfInterpolant<3>;

}  // namespace sansmesh::inline v1
