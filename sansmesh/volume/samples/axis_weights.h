// Reconstruction along one axis of a lattice: weights of the samples next to a coordinate.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace sansmesh::inline v1::detail {

inline constexpr std::size_t kMostAxisWeights = 8;

/// f(x) = Σ_j value[j] f_{first + j}, f'(x) = Σ_j slope[j] f_{first + j}, j < count.
struct AxisWeights {
  std::size_t first = 0, count = 0;
  std::array<double, kMostAxisWeights> value, slope;  // not set beyond count
};

/// Piecewise cubic in Hermite form: at knot i value Σ_j value[i][j] f_{b + j}, slope Σ_j slope[i][j] f_{b + j} with b =
/// clamp(i − 1, 0, n − 3). On even steps it is the BC family (mitchell1988): value f_i + B/6 (f_{i+1} − 2 f_i +
/// f_{i−1}), slope (B/2 + C)(f_{i+1} − f_{i−1}). On uneven steps the slope is (B + 2C) times that of the parabola
/// through the three samples, and the parabola's second derivative replaces the difference; at the ends the parabola
/// through the last three samples gives the slope, and the value is the sample. Continuously differentiable; reproduces
/// straight lines if B + 2C = 1, and parabolas if B = 0 and C = ½. Continued linearly beyond the ends.
class CubicAxis {
 public:
  static constexpr std::size_t kCount = 4;  ///< largest number of weights; smaller with fewer knots

  CubicAxis() = default;
  /// Knots: strictly increasing, at least two.
  CubicAxis(std::span<const double> knots, bool uniform, double b, double c);
  void weights(double x, AxisWeights& out) const;
  /// Weights of the slope at a knot, for samples from `first` on.
  const std::array<double, 3>& slope_at(std::size_t knot, std::size_t& first) const {
    first = base(knot);
    return slope_[knot];
  }
  std::size_t size() const { return knots_.size(); }
  /// Samples with weights anywhere from coordinate a to b: first and last.
  std::pair<std::size_t, std::size_t> samples_of(double a, double b) const {
    const Piece &from = pieces_[piece_at(a)], &to = pieces_[piece_at(b)];
    return {from.first, std::min(to.first + kCount, knots_.size()) - 1};
  }
  /// Largest sum of the absolute weights from coordinate a to b.
  double most_weight(double a, double b) const {
    return a < knots_.front() || b > knots_.back() ? most_beyond_ : most_within_;
  }

 private:
  std::size_t piece_at(double x) const;
  void find_most_weights();
  std::size_t base(std::size_t knot) const {
    return knots_.size() <= 3 || knot == 0 ? 0 : knot - 1 < knots_.size() - 3 ? knot - 1 : knots_.size() - 3;
  }

  /// Weights in an interval as cubics of u = (x − knot) · inverse, 0..1.
  struct Piece {
    double knot = 0, inverse = 0;
    std::size_t first = 0;
    std::array<std::array<double, kCount>, 4> powers{};
  };
  Piece piece_of(std::size_t interval) const;

  std::vector<double> knots_;
  std::vector<std::array<double, 3>> value_, slope_;
  std::vector<Piece> pieces_;
  double inverse_step_ = 0;  // > 0 on uniform axes
  double most_within_ = 1, most_beyond_ = 1;
};

/// Windowed sinc, normalised: (1 + cos(πt/4)) sinc(t) for |t| < 4 steps, divided by the sum. Samples beyond the ends
/// are odd reflections. Requires uniform knots.
class SincAxis {
 public:
  explicit SincAxis(std::span<const double> knots);
  void weights(double x, AxisWeights& out) const;
  std::size_t size() const { return count_; }

 private:
  double start_, step_;
  std::size_t count_;
};

/// Odd degree p: the polynomial through the p + 1 samples around an interval. Even degree p: two such polynomials,
/// through p + 1 samples that begin one apart, blended linearly over the interval. Near the ends and with few samples
/// the nearest ones are used. Interpolating; continuous for odd degrees, continuously differentiable for even ones.
class LagrangeAxis {
 public:
  /// Degree 1..5, reduced to fit the number of knots (at least two).
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
