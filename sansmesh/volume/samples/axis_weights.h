// Reconstruction along one axis of a lattice: weights of the samples next to a coordinate (METHODS §6.3).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace sansmesh::inline v1::detail {

inline constexpr std::size_t kMostAxisWeights = 8;

/// f(x) = Σ_j value[j] f_{first + j}, f'(x) = Σ_j slope[j] f_{first + j}, j < count.
struct AxisWeights {
  std::size_t first = 0, count = 0;
  std::array<double, kMostAxisWeights> value{}, slope{};
};

/// Piecewise cubic in Hermite's form: at knot i value Σ_j value[i][j] f_{b + j}, slope Σ_j slope[i][j] f_{b + j} with
/// b = clamp(i − 1, 0, n − 3). On even steps that is the BC family of Mitchell and Netravali (mitchell1988): value
/// f_i + B/6 (f_{i+1} − 2 f_i + f_{i−1}), slope (B/2 + C)(f_{i+1} − f_{i−1}). On uneven ones the slope is (B + 2C)
/// times that of the parabola through the three samples, the difference that of the parabola's second derivative; at
/// the ends the parabola through the last three samples gives the slope, and the value is the sample. Continuously
/// differentiable; straight lines are reproduced where B + 2C = 1, parabolas where B = 0 and C = ½. Beyond the ends it
/// goes on straight.
class CubicAxis {
 public:
  static constexpr std::size_t kCount = 4;  ///< weights at most: fewer where there are fewer knots

  CubicAxis() = default;
  /// Knots: strictly increasing, at least two.
  CubicAxis(std::span<const double> knots, bool uniform, double b, double c);
  void weights(double x, AxisWeights& out) const;
  /// Weights of the slope at a knot; samples from `first` on.
  const std::array<double, 3>& slope_at(std::size_t knot, std::size_t& first) const {
    first = base(knot);
    return slope_[knot];
  }
  std::size_t size() const { return knots_.size(); }

 private:
  std::size_t base(std::size_t knot) const {
    return knots_.size() <= 3 || knot == 0 ? 0 : knot - 1 < knots_.size() - 3 ? knot - 1 : knots_.size() - 3;
  }

  std::vector<double> knots_;
  std::vector<std::array<double, 3>> value_, slope_;
  double inverse_step_ = 0;  // > 0 on uniform axes
};

/// Windowed sinc, normalised: (1 + cos(πt/4)) sinc(t) for |t| < 4 steps, over the sum. Samples beyond the ends are
/// those of the odd reflection. Uniform knots.
class SincAxis {
 public:
  explicit SincAxis(std::span<const double> knots);
  void weights(double x, AxisWeights& out) const;
  std::size_t size() const { return count_; }

 private:
  double start_, step_;
  std::size_t count_;
};

/// The polynomial of odd degree p through the p + 1 samples around an interval; of even degree two of them, through the
/// p + 1 samples that begin one apart, blended linearly over the interval. At the ends and where there are fewer
/// samples the nearest ones. Interpolates; continuous for odd degrees, continuously differentiable for even ones.
class LagrangeAxis {
 public:
  /// Degree 1..5; as many knots as there are, at least two, let the degree be.
  LagrangeAxis(std::span<const double> knots, bool uniform, int degree);
  void weights(double x, AxisWeights& out) const;
  std::size_t size() const { return knots_.size(); }

 private:
  void polynomial(std::size_t first, double x, double* value, double* slope) const;

  std::vector<double> knots_;
  bool uniform_;
  std::size_t degree_;
};

}  // namespace sansmesh::inline v1::detail
