// Radial functions: radial basis functions, weights of moving least squares and the Laguerre–Gaussians of approximate
// moving least squares (tejada2008, ch. 3; wendland2004, fasshauer2007book).
#pragma once

#include <cmath>
#include <limits>
#include <string_view>

namespace sansmesh::inline v1 {

/// Value of a function of r = ‖x − x_i‖ and its slope φ'(r)/r: the gradient is slope · (x − x_i).
struct RadialValue {
  double value = 0;
  double slope = 0;
};

/// Radial basis functions of t = r / scale. The signs make each (conditionally) positive definite in up to three
/// variables; the order is that of conditional positive definiteness: an interpolant needs polynomials of degree <
/// order.
enum class RadialFunction {
  kThinPlate,            ///< "thin-plate": t² log t, order 2
  kBiharmonic,           ///< "biharmonic": −t, order 1
  kTriharmonic,          ///< "triharmonic": t³, order 2
  kMultiquadric,         ///< "multiquadric": −√(1 + t²), order 1
  kInverseMultiquadric,  ///< "inverse-multiquadric": 1/√(1 + t²), order 0
  kGaussian,             ///< "gaussian": exp(−t²), order 0
  kWendlandC2,           ///< "wendland-c2": (1 − t)⁴₊ (4t + 1), order 0 (wendland1995)
  kWendlandC4            ///< "wendland-c4": (1 − t)⁶₊ (35t² + 18t + 3) / 3, order 0
};

std::string_view name_of(RadialFunction function);

/// One radial basis function with its scale, a length > 0 (interpolants with the first three do not depend on it).
class RadialKernel {
 public:
  /// Throws ArgumentError for a scale that is not positive and finite.
  explicit RadialKernel(RadialFunction function, double scale = 1);

  RadialFunction function() const { return function_; }
  double scale() const { return scale_; }
  /// The function is zero from this distance on; infinite for all but Wendland's functions.
  double support() const { return is_compact() ? scale_ : std::numeric_limits<double>::infinity(); }
  bool is_compact() const {
    return function_ == RadialFunction::kWendlandC2 || function_ == RadialFunction::kWendlandC4;
  }
  /// Order of conditional positive definiteness: the interpolant needs polynomials of degree < order().
  int order() const {
    switch (function_) {
      case RadialFunction::kThinPlate:
      case RadialFunction::kTriharmonic:
        return 2;
      case RadialFunction::kBiharmonic:
      case RadialFunction::kMultiquadric:
        return 1;
      default:
        return 0;
    }
  }

  /// φ of a squared distance.
  double operator()(double r2) const {
    const double t2 = r2 * inverse_square_;
    switch (function_) {
      case RadialFunction::kThinPlate:
        return t2 > 0 ? 0.5 * t2 * std::log(t2) : 0;
      case RadialFunction::kBiharmonic:
        return -std::sqrt(t2);
      case RadialFunction::kTriharmonic:
        return t2 * std::sqrt(t2);
      case RadialFunction::kMultiquadric:
        return -std::sqrt(1 + t2);
      case RadialFunction::kInverseMultiquadric:
        return 1 / std::sqrt(1 + t2);
      case RadialFunction::kGaussian:
        return std::exp(-t2);
      case RadialFunction::kWendlandC2: {
        if (t2 >= 1) return 0;
        const double t = std::sqrt(t2), q = (1 - t) * (1 - t);
        return q * q * (4 * t + 1);
      }
      case RadialFunction::kWendlandC4: {
        if (t2 >= 1) return 0;
        const double t = std::sqrt(t2), q = (1 - t) * (1 - t);
        return q * q * q * (35 * t2 + 18 * t + 3) / 3;
      }
    }
    return 0;
  }
  /// φ and φ'/r. At r = 0, where t and t² log t have no derivative, the slope is 0.
  RadialValue with_slope(double r2) const;

 private:
  RadialFunction function_;
  double scale_;
  double inverse_square_;
};

/// Weights of moving least squares; t = r / radius, zero for t >= 1.
enum class WeightFunction {
  kCompact,   ///< "compact": (1 − t²)⁴, three continuous derivatives
  kWendland,  ///< "wendland": (1 − t)⁴ (4t + 1), two continuous derivatives
  kGaussian   ///< "gaussian": exp(−9t²) − exp(−9), continuous; its slope jumps by 0.2 % of the peak at t = 1
};
std::string_view name_of(WeightFunction function);
/// Weight and slope for a squared distance and a radius > 0.
RadialValue weight(WeightFunction function, double r2, double radius);

/// Generating function of approximate moving least squares in `dimension` variables,
///   φ(ρ) = (ε/π)^{s/2} L_d^{(s/2)}(ρ) exp(−ρ), ρ = ε r² / h², order 2d + 2
/// (mazya2001, fasshauer2007book). Its moments up to 2d + 1 are those of a delta function.
class LaguerreGaussian {
 public:
  /// dimension 1..3, order 2, 4 or 6, shape ε > 0, spacing h > 0; ArgumentError otherwise.
  LaguerreGaussian(int dimension, int order, double shape, double spacing);

  double operator()(double r2) const {
    const double rho = r2 * factor_, e = scale_ * std::exp(-rho);
    return (l_[0] + rho * (l_[1] + rho * l_[2])) * e;
  }
  RadialValue with_slope(double r2) const {
    const double rho = r2 * factor_, e = scale_ * std::exp(-rho);
    // d/dρ (L_d^{(α)} e^{−ρ}) = −L_d^{(α+1)} e^{−ρ}, and dρ/dr / r = 2 ε / h².
    return {(l_[0] + rho * (l_[1] + rho * l_[2])) * e, -2 * factor_ * (m_[0] + rho * (m_[1] + rho * m_[2])) * e};
  }
  /// (ε/π)^{s/2} exp(−ρ), the function of order 2, and its slope.
  RadialValue gaussian(double r2) const {
    const double e = scale_ * std::exp(-r2 * factor_);
    return {e, -2 * factor_ * e};
  }
  /// Distance beyond which |φ| stays below `fraction` (in (0, 1)) of φ(0).
  double cutoff(double fraction) const;

 private:
  double factor_;  // ε / h²
  double scale_;   // (ε/π)^{s/2}
  double l_[3], m_[3];
};

}  // namespace sansmesh::inline v1
