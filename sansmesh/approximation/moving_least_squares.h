// Moving least squares of any degree through orthogonal polynomials (METHODS §1.2, §1.3; tejada2008 ch. 3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1 {

struct MovingLeastSquaresOptions {
  /// Degree of the local polynomials, 0 (Shepard) to 8.
  int degree = 2;
  WeightFunction weight = WeightFunction::kCompact;
  /// Radius of the samples' weights, a length > 0, the same for all. Unset: each sample's own, the distance to its
  /// `neighbours`-th neighbour, so that it follows the density.
  std::optional<double> radius = {};
  /// How many neighbours a sample's weight reaches, >= 1. Unset: three times the number of monomials up to `degree`
  /// and five more.
  std::optional<std::size_t> neighbours = {};
  /// See OrthogonalFitOptions.
  double rank_tolerance = 1e-6;
};

/// M f(x) = p_x(x), where p_x is the polynomial that minimises Σ_i w_i(x) (f_i − p(x_i))². Weights belong to the
/// samples, w_i(x) = w(‖x − x_i‖ / radius_i), hence M f is as smooth as w also where the radius follows the density. It
/// reproduces polynomials of its degree.
///
/// Where fewer samples have a weight than there are monomials, the degree is lowered to the highest with no more
/// monomials than samples; polynomials that vanish on the samples (collinear, coplanar ones) are dropped
/// (OrthogonalFit). M f may jump where that changes. Where no sample has a weight: the value of the nearest, gradient
/// 0. Results do not depend on the number of threads.
template <int D>
class MovingLeastSquares {
 public:
  /// Throws ArgumentError for options out of range and for another number of values than positions, DataError for no
  /// samples and for positions or values that are not finite.
  MovingLeastSquares(std::span<const Position<D>> positions, std::span<const double> values,
                     const MovingLeastSquaresOptions& options = {});

  /// Values at the points; `gradients`, empty or one per point, are the exact derivatives of the values (that of the
  /// weights included, not only that of p_x); `degrees`, empty or one per point, tell the degree used, −1 where no
  /// sample has a weight. Points that are not finite: value NaN, degree −1. Throws ArgumentError for other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<Position<D>> gradients = {},
                std::span<std::int8_t> degrees = {}) const;

  const MovingLeastSquaresOptions& options() const { return options_; }
  /// Radius of every sample's weight.
  std::span<const double> radii() const { return radii_; }

 private:
  // Samples of similar radius share a tree: a query searches each within its largest radius.
  struct Layer {
    SampleIndex<D> index;
    std::vector<std::uint32_t> sample;
    double radius = 0;
  };
  struct Scratch;
  void evaluate_one(const Position<D>& x, Scratch& scratch, double& value, Position<D>* gradient, int& degree) const;

  MovingLeastSquaresOptions options_;
  SampleIndex<D> index_;
  std::vector<double> values_, radii_;
  std::vector<Layer> layers_;
};

extern template class MovingLeastSquares<1>;
extern template class MovingLeastSquares<2>;
extern template class MovingLeastSquares<3>;

}  // namespace sansmesh::inline v1
