// Moving least squares of any degree with orthogonal polynomials (tejada2008, ch. 3; bartels1985).
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
  /// Radius of the samples' weights, a length > 0, the same for all. Unset: the distance of each sample to its
  /// `neighbours`-th neighbour, which follows the density.
  std::optional<double> radius = {};
  /// Number of neighbours within a sample's weight, >= 1. Unset: three times the number of monomials up to `degree`,
  /// plus five.
  std::optional<std::size_t> neighbours = {};
  /// See OrthogonalFitOptions.
  double rank_tolerance = 1e-6;
};

/// M f(x) = p_x(x), where p_x is the polynomial that minimises Σ_i w_i(x) (f_i − p(x_i))². Radii belong to the samples,
/// w_i(x) = w(‖x − x_i‖ / radius_i), so M f is as smooth as w even if the radius varies. It reproduces polynomials
/// of its degree.
///
/// If fewer samples have a weight than there are monomials, the degree is lowered to the highest with no more monomials
/// than samples. Polynomials that vanish on the samples (collinear, coplanar ones) are dropped (OrthogonalFit). M f may
/// jump at such changes. Where no sample has a weight, the value is that of the nearest sample and the gradient is 0.
/// Results do not depend on the number of threads.
template <int D>
class MovingLeastSquares {
 public:
  /// Throws ArgumentError for options out of range and for another number of values than positions, DataError for no
  /// samples and for positions or values that are not finite.
  MovingLeastSquares(std::span<const Position<D>> positions, std::span<const double> values,
                     const MovingLeastSquaresOptions& options = {});

  /// Values at the points. `gradients`, empty or one per point, are the exact derivatives of the values, including
  /// those of the weights. `degrees`, empty or one per point, are the degrees used, −1 where no sample has a weight.
  /// Points that are not finite: value NaN, degree −1. Throws ArgumentError for other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<Position<D>> gradients = {},
                std::span<std::int8_t> degrees = {}) const;

  const MovingLeastSquaresOptions& options() const { return options_; }
  /// Radius of every sample's weight.
  std::span<const double> radii() const { return radii_; }

 private:
  // Samples of similar radius share a tree: a query searches each tree within its largest radius.
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
