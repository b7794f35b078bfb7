// Least-squares fit of the curvatures around one point: shared by the estimates at samples and at vertices.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sansmesh/surface/fitted_curvatures.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Radius of neighbourhoods over h: exp(−1.6²) = 0.08.
inline constexpr double kReachOverWidth = 1.6;
inline constexpr std::size_t kCurvatureUnknowns = 6;

/// Whether a neighbour may belong to the same sheet.
inline bool same_sheet(const Vec3& normal, const Vec3f& neighbours_normal) {
  return dot(normal, Vec3(neighbours_normal)) >= 0;
}

/// Σ w row rowᵀ and Σ w row value, lower triangle only, for the first `n` of the six unknowns.
struct NormalEquations {
  std::array<std::array<double, kCurvatureUnknowns>, kCurvatureUnknowns> a{};
  std::array<double, kCurvatureUnknowns> right{};
  std::array<std::size_t, kCurvatureUnknowns> active{};
  std::size_t n = 0;

  void add(const std::array<double, kCurvatureUnknowns>& row, double w, double value) {
    for (std::size_t i = 0; i < kCurvatureUnknowns; ++i) {
      const double wr = w * row[i];
      for (std::size_t j = 0; j <= i; ++j) a[i][j] += wr * row[j];
      right[i] += wr * value;
    }
  }

  /// LDLᵀ in place; false if an unknown is (nearly) a combination of the others.
  bool factorise() {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t ai = active[i];
      const double before = a[ai][ai];
      for (std::size_t j = 0; j <= i; ++j) {
        const std::size_t aj = active[j];
        double s = a[ai][aj];
        for (std::size_t k = 0; k < j; ++k) s -= l_[i][k] * l_[j][k] * d_[k];
        if (j < i)
          l_[i][j] = s / d_[j];
        else
          d_[i] = s;
      }
      if (!(d_[i] > 1e-6 * before)) return false;
    }
    return true;
  }

  std::array<double, kCurvatureUnknowns> solve(const std::array<double, kCurvatureUnknowns>& b) const {
    std::array<double, kCurvatureUnknowns> y{}, x{};
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = b[active[i]];
      for (std::size_t k = 0; k < i; ++k) y[i] -= l_[i][k] * y[k];
    }
    for (std::size_t i = n; i-- > 0;) {
      y[i] /= d_[i];
      for (std::size_t k = i + 1; k < n; ++k) y[i] -= l_[k][i] * y[k];
      x[active[i]] = y[i];
    }
    return x;
  }

 private:
  std::array<std::array<double, kCurvatureUnknowns>, kCurvatureUnknowns> l_{};
  std::array<double, kCurvatureUnknowns> d_{};
};

/// Fits one neighbourhood after another without allocations in the loop. Lengths are divided by the radius of the
/// neighbourhood.
///
/// The equation of a neighbour, κ_i = χ₁ + χ₂ cos 2θ + χ₃ sin 2θ, times −‖d‖²/2 is an equation of heights z = ⟨n, d⟩: z
/// = −½(‖d‖² χ₁ + c χ₂ + s χ₃) [+ δ] [+ a u + b v], with weight w_i · 4/‖d‖⁴. An offset and slopes can be added.
class CurvatureFitter {
 public:
  explicit CurvatureFitter(const CurvatureOptions& options) : options_(options) {}

  void start(const Vec3& normal) {
    normal_ = normal;
    tangent_frame(normal, t_, b_);
    offsets_.clear();
  }
  void add(const Vec3& offset) { offsets_.push_back({dot(offset, t_), dot(offset, b_), dot(offset, normal_)}); }

  /// Fits the first `count` offsets, all within `radius`.
  bool fit(std::size_t count, double radius) {
    radius_ = radius;
    equations_ = {};
    // χ first: they stay determined where the slopes are not.
    equations_.active = {0, 1, 2};
    equations_.n = 3;
    if (options_.offset) equations_.active[equations_.n++] = 3;
    if (options_.refit_normal) equations_.active[equations_.n++] = 4, equations_.active[equations_.n++] = 5;
    if (!(radius > 0)) return false;
    const double scale = 1 / radius;
    std::size_t used = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, kCurvatureUnknowns> row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      equations_.add(row, weight, height);
      ++used;
    }
    if (used <= equations_.n || !equations_.factorise()) return false;
    solution_ = equations_.solve(equations_.right);
    return std::all_of(solution_.begin(), solution_.end(), [](double c) { return std::isfinite(c); });
  }

  /// χ₁, χ₂, χ₃ of the last fit.
  std::array<double, 3> chi() const { return {solution_[0] / radius_, solution_[1] / radius_, solution_[2] / radius_}; }

  /// Sum of the variances of χ₁, χ₂ and χ₃ for heights of unit variance.
  double variance(std::size_t count) const {
    std::array<std::array<double, kCurvatureUnknowns>, 3> inverse;
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, kCurvatureUnknowns> unit{};
      unit[c] = 1;
      inverse[c] = equations_.solve(unit);
    }
    double sum = 0;
    const double scale = 1 / radius_;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, kCurvatureUnknowns> row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      for (const auto& line : inverse) {
        double influence = 0;
        for (std::size_t k = 0; k < kCurvatureUnknowns; ++k) influence += line[k] * row[k];
        sum += influence * influence * weight * weight;
      }
    }
    return sum / (radius_ * radius_ * radius_ * radius_);
  }

  /// The fit is a quadric, the zero set of F = z + ½(χ₁‖d‖² + χ₂(u² − v²) + 2 χ₃ u v) − δ − a u − b v: its curvatures
  /// at the foot (0, 0, δ) are those of F's Hessian across the gradient.
  FittedCurvatures curvatures() const {
    const auto [c1, c2, c3, delta, a, b] = solution_;
    const Vec3 gradient{-a, -b, 1 + c1 * delta};
    const double length = norm(gradient);
    FittedCurvatures result;
    if (!(gradient.z > 0)) return result;
    const Vec3 n = gradient / length;
    Vec3 e, f;
    tangent_frame(n, e, f);
    const auto hessian = [&, c1 = c1, c2 = c2, c3 = c3](const Vec3& p, const Vec3& q) {
      return (c1 * dot(p, q) + c2 * (p.x * q.x - p.y * q.y) + c3 * (p.x * q.y + p.y * q.x)) / (length * radius_);
    };
    const double ee = hessian(e, e), ef = hessian(e, f), ff = hessian(f, f);
    const double mean = 0.5 * (ee + ff), half = 0.5 * (ee - ff), spread = std::hypot(half, ef);
    // Eigenvector of mean + spread, from the row without cancellation.
    Vec3 first = half >= 0 ? e * (spread + half) + f * ef : e * ef + f * (spread - half);
    first = spread > 0 ? normalized(first) : e;
    const Vec3 second = cross(n, first);
    const auto world = [&](const Vec3& p) { return Vec3f(t_ * p.x + b_ * p.y + normal_ * p.z); };
    result.k1 = static_cast<float>(mean + spread);
    result.k2 = static_cast<float>(mean - spread);
    result.direction1 = world(first);
    result.direction2 = world(second);
    result.normal = world(n);
    result.offset = static_cast<float>(delta * radius_);
    result.defined = true;
    return result;
  }

 private:
  /// Row, weight and height of one neighbour (lengths in radii); false for one without weight.
  bool equation(const Vec3& d, std::array<double, kCurvatureUnknowns>& row, double& weight, double& height) const {
    const double flat = d.x * d.x + d.y * d.y, squared = flat + d.z * d.z;
    constexpr double kCoincident = 1e-10;
    if (!(flat > kCoincident)) return false;
    // With χ as the only unknowns, the equations are those of tejada2008: only angles count. Equations of a quadric are
    // more stable if the offset allows samples above or below the point.
    const double turn = options_.offset || options_.refit_normal ? 1 : squared / flat;
    row = {-0.5 * squared, -0.5 * turn * (d.x * d.x - d.y * d.y), -turn * d.x * d.y, 1, d.x, d.y};
    height = d.z;
    weight = 1 / (squared * squared);
    if (options_.weights == CurvatureOptions::Weights::m_like)
      for (int k = 0; k < options_.tau; ++k) weight *= squared;
    if (options_.weights != CurvatureOptions::Weights::uniform)
      weight *= std::exp(-kReachOverWidth * kReachOverWidth * squared);
    return true;
  }

  const CurvatureOptions& options_;
  Vec3 normal_, t_, b_;
  std::vector<Vec3> offsets_;
  NormalEquations equations_;
  std::array<double, kCurvatureUnknowns> solution_{};
  double radius_ = 1;
};

}  // namespace sansmesh::inline v1::detail
