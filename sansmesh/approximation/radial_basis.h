// Interpolation with radial basis functions and a polynomial (METHODS §1.1; wendland2004).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1 {

enum class RbfSolver {
  kAutomatic,  ///< kDense up to 1,500 samples; beyond, kSparse for Wendland's functions and kLocal for all others
  kDense,      ///< one system of all samples by Cholesky; O(n³), at most kMaxDense samples
  kSparse,     ///< the same for Wendland's functions by preconditioned conjugate gradients
  kLocal       ///< many small systems, blended by a partition of unity: O(n) (babuska1997, cavoretto2016)
};

struct RbfOptions {
  RadialFunction function = RadialFunction::kBiharmonic;
  /// Scale of the function, a length > 0. Unset: SampleIndex::spacing() times 2 for multiquadrics, inverse
  /// multiquadrics and Gaussians, times 16, 8 and 4 in one, two and three variables for Wendland's functions (their
  /// support: 32, 200 and 270 samples), times 1 for the others.
  std::optional<double> scale = {};
  /// Degree of the polynomial that is added, −1 (none) to 2, at least RadialKernel::order() − 1. Unset: 1.
  std::optional<int> degree = {};
  /// λ >= 0, dimensionless, added to the diagonal: 0 interpolates, more smooths. |φ(0)| is 1, or 0 for the first three
  /// functions, where λ counts in units of φ at about the distance of the scale.
  double ridge = 0;
  RbfSolver solver = RbfSolver::kAutomatic;
  /// kLocal: least number of samples per system (if there are that many), 10 to 400.
  std::size_t local_samples = 50;
  /// kSparse: the residual relative to the values at which the iteration ends, in (0, 1).
  double tolerance = 1e-10;
  int max_iterations = 2000;
};

/// What fitting did; nothing of it is an error.
struct RbfReport {
  RbfSolver solver = RbfSolver::kDense;
  double scale = 0;             ///< scale of the function
  std::size_t merged = 0;       ///< samples that coincide with an earlier one: their values were averaged
  int dropped_polynomials = 0;  ///< that vanish on the samples (coplanar, too few); the largest number of all systems
  double added_ridge = 0;       ///< what had to be added to λ for a system to be solvable; the largest of all systems
  int iterations = 0;           ///< of conjugate gradients
  double residual = 0;          ///< of conjugate gradients, relative
  std::size_t systems = 1;      ///< kLocal: how many
};

/// f(x) = Σ_i c_i φ(‖x − x_i‖) + p(x), Σ_i c_i q(x_i) = 0 for all polynomials q of p's degree. Interpolates (λ = 0) and
/// reproduces polynomials of that degree. Results do not depend on the number of threads.
///
/// kLocal covers the samples' box by balls around the cells of an adaptive subdivision, interpolates the samples of
/// each ball and blends: the result interpolates as well, has continuous first derivatives as far as φ has, and needs
/// linear time, but far from samples it is not that of the system of all. Beyond the box by more than a tenth of its
/// size the weights are those of the nearest point of the enlarged box.
template <int D>
class RbfInterpolant {
 public:
  static constexpr std::size_t kMaxDense = 4000;

  /// Throws ArgumentError for options out of range, for kSparse without compact support and for kDense with more than
  /// kMaxDense samples, DataError for no samples and positions or values that are not finite, where more than 2^30
  /// pairs of samples lie within the support, and where conjugate gradients do not reach the tolerance.
  RbfInterpolant(std::span<const Position<D>> positions, std::span<const double> values,
                 const RbfOptions& options = {});
  ~RbfInterpolant();
  RbfInterpolant(RbfInterpolant&&) noexcept;
  RbfInterpolant& operator=(RbfInterpolant&&) noexcept;

  /// Values, and gradients where asked for (empty or one per point). NaN at points that are not finite. Throws
  /// ArgumentError for spans of other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<Position<D>> gradients = {}) const;

  const RbfReport& report() const { return report_; }
  const RbfOptions& options() const { return options_; }

 private:
  struct State;
  RbfOptions options_;
  RbfReport report_;
  std::unique_ptr<State> state_;
};

extern template class RbfInterpolant<1>;
extern template class RbfInterpolant<2>;
extern template class RbfInterpolant<3>;

}  // namespace sansmesh::inline v1
