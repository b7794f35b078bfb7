// Least-squares fit of the curvatures around one point: shared by the estimates at samples and at vertices.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/surface/fitted_curvatures.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Radius of neighbourhoods over h: exp(−1.6²) = 0.08.
inline constexpr double kReachOverWidth = 1.6;
/// Unknowns of a quadric, and of a quartic graph over it.
inline constexpr std::size_t kCurvatureUnknowns = 6, kQuarticUnknowns = 15;

/// Surfaces that are fitted to a neighbourhood.
enum class CurvatureSurface : std::uint8_t {
  quadric,  ///< as the options require
  /// Quadric with terms of third and fourth degree, for samples without noise: its error falls with the fourth power of
  /// the radius on symmetric neighbourhoods, that of the quadric with the second.
  quartic,
  quartic_through,  ///< the same through the point
  /// Directional curvatures of the next vertices, with a tilt of the normal, through the point: exact along circles of
  /// any radius, so for coarse meshes.
  directional
};

/// Whether a neighbour may belong to the same sheet.
inline bool same_sheet(const Vec3& normal, const Vec3f& neighbours_normal) {
  return dot(normal, Vec3(neighbours_normal)) >= 0;
}

/// Σ w row rowᵀ and Σ w row value, lower triangle only, for the first `n` of the unknowns.
template <std::size_t kUnknowns>
struct NormalEquations {
  using Row = std::array<double, kUnknowns>;
  std::array<Row, kUnknowns> a{};
  Row right{};
  std::array<std::size_t, kUnknowns> active{};
  std::size_t n = 0;

  template <class Values>
  void add(const Values& row, double w, double value) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      const double wr = w * row[i];
      for (std::size_t j = 0; j <= i; ++j) a[i][j] += wr * row[j];
      right[i] += wr * value;
    }
  }

  /// LDLᵀ in place; false if an unknown is (nearly) a combination of the others.
  bool factorise(double least_pivot) {
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
      if (!(d_[i] > least_pivot * before)) return false;
    }
    return true;
  }

  template <class Values>
  void solve(const Row& b, Values& x) const {
    Row y{};
    x.fill(0);
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = b[active[i]];
      for (std::size_t k = 0; k < i; ++k) y[i] -= l_[i][k] * y[k];
    }
    for (std::size_t i = n; i-- > 0;) {
      y[i] /= d_[i];
      for (std::size_t k = i + 1; k < n; ++k) y[i] -= l_[k][i] * y[k];
      x[active[i]] = y[i];
    }
  }

 private:
  std::array<Row, kUnknowns> l_{};
  Row d_{};
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
  bool fit(std::size_t count, double radius, CurvatureSurface surface = CurvatureSurface::quadric) {
    radius_ = radius, surface_ = surface;
    if (!(radius > 0)) return false;
    // χ first: they stay determined where the slopes are not.
    if (surface == CurvatureSurface::quartic || surface == CurvatureSurface::quartic_through) {
      quartic_ = {};
      for (std::size_t k = 0; k < kQuarticUnknowns; ++k)
        if (k != 3 || surface == CurvatureSurface::quartic) quartic_.active[quartic_.n++] = k;
      return solve(quartic_, count, kLeastQuarticPivot, true);
    }
    const bool directional = surface == CurvatureSurface::directional;
    quadric_ = {};
    quadric_.active = {0, 1, 2};
    quadric_.n = 3;
    if (options_.offset && !directional) quadric_.active[quadric_.n++] = 3;
    if (options_.refit_normal || directional) quadric_.active[quadric_.n++] = 4, quadric_.active[quadric_.n++] = 5;
    return solve(quadric_, count, 1e-6, directional);
  }

  /// The same, or a quadric if the surface is not determined.
  bool fit_or_quadric(std::size_t count, double radius, CurvatureSurface surface) {
    return fit(count, radius, surface) || (surface != CurvatureSurface::quadric && fit(count, radius));
  }

  /// χ₁, χ₂, χ₃ of the last fit.
  std::array<double, 3> chi() const { return {solution_[0] / radius_, solution_[1] / radius_, solution_[2] / radius_}; }

  /// Sum of the variances of χ₁, χ₂ and χ₃ for heights of unit variance.
  double variance(std::size_t count) const {
    return is_quartic() ? variance_of(quartic_, count) : variance_of(quadric_, count);
  }

  /// Variance of the heights about the fitted surface (length²), unbiased for noise.
  double residual_variance(std::size_t count) const {
    const double scale = 1 / radius_;
    double sum = 0, weights = 0;
    std::size_t used = 0;
    for (std::size_t i = 0; i < count; ++i) {
      Row row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      for (std::size_t k = 0; k < (is_quartic() ? kQuarticUnknowns : kCurvatureUnknowns); ++k)
        height -= row[k] * solution_[k];
      sum += weight * height * height, weights += weight;
      ++used;
    }
    const std::size_t unknowns = is_quartic() ? quartic_.n : quadric_.n;
    if (used <= unknowns) return 0;
    return radius_ * radius_ * sum / weights * static_cast<double>(used) / static_cast<double>(used - unknowns);
  }

  /// The fit is a quadric, the zero set of F = z + ½(χ₁‖d‖² + χ₂(u² − v²) + 2 χ₃ u v) − δ − a u − b v: its curvatures
  /// at the foot (0, 0, δ) are those of F's Hessian across the gradient. Terms of higher degree contribute nothing
  /// there.
  FittedCurvatures curvatures() const {
    const double c1 = solution_[0], c2 = solution_[1], c3 = solution_[2], delta = solution_[3], a = solution_[4],
                 b = solution_[5];
    const Vec3 gradient{-a, -b, 1 + c1 * delta};
    const double length = norm(gradient);
    FittedCurvatures result;
    if (!(gradient.z > 0)) return result;
    const Vec3 n = gradient / length;
    Vec3 e, f;
    tangent_frame(n, e, f);
    const auto hessian = [&](const Vec3& p, const Vec3& q) {
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
  using Row = std::array<double, kQuarticUnknowns>;
  /// Nine unknowns of higher degree in the same lengths: pivots are smaller than those of quadrics.
  static constexpr double kLeastQuarticPivot = 1e-8;

  bool is_quartic() const {
    return surface_ == CurvatureSurface::quartic || surface_ == CurvatureSurface::quartic_through;
  }

  template <std::size_t kUnknowns>
  bool solve(NormalEquations<kUnknowns>& equations, std::size_t count, double least_pivot, bool just_enough) {
    const double scale = 1 / radius_;
    std::size_t used = 0;
    for (std::size_t i = 0; i < count; ++i) {
      Row row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      equations.add(row, weight, height);
      ++used;
    }
    if (used < equations.n + (just_enough ? 0 : 1) || !equations.factorise(least_pivot)) return false;
    equations.solve(equations.right, solution_);
    return std::all_of(solution_.begin(), solution_.end(), [](double c) { return std::isfinite(c); });
  }

  template <std::size_t kUnknowns>
  double variance_of(const NormalEquations<kUnknowns>& equations, std::size_t count) const {
    std::array<std::array<double, kUnknowns>, 3> inverse;
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, kUnknowns> unit{};
      unit[c] = 1;
      equations.solve(unit, inverse[c]);
    }
    double sum = 0;
    const double scale = 1 / radius_;
    for (std::size_t i = 0; i < count; ++i) {
      Row row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      for (const auto& line : inverse) {
        double influence = 0;
        for (std::size_t k = 0; k < kUnknowns; ++k) influence += line[k] * row[k];
        sum += influence * influence * weight * weight;
      }
    }
    return sum / (radius_ * radius_ * radius_ * radius_);
  }

  /// Row, weight and height of one neighbour (lengths in radii); false for one without weight.
  bool equation(const Vec3& d, Row& row, double& weight, double& height) const {
    const double flat = d.x * d.x + d.y * d.y, squared = flat + d.z * d.z;
    constexpr double kCoincident = 1e-10;
    const bool quartic = is_quartic(), directional = surface_ == CurvatureSurface::directional;
    // The point itself has no direction, but a height.
    if (!(flat > kCoincident) && !(quartic && squared == 0)) return false;
    // With χ as the only unknowns, the equations are those of tejada2008: only angles count. Equations of a quadric are
    // more stable if the offset allows samples above or below the point.
    const double turn = directional || (!quartic && !options_.offset && !options_.refit_normal) ? squared / flat : 1;
    row[0] = -0.5 * squared, row[1] = -0.5 * turn * (d.x * d.x - d.y * d.y), row[2] = -turn * d.x * d.y;
    row[3] = 1, row[4] = d.x, row[5] = d.y;
    height = d.z;
    if (quartic || directional) {
      const double narrow = directional ? 1 : kReachOverWidth * kReachOverWidth;
      weight = std::exp(-narrow * squared);
      if (directional) return true;
      const double uu = d.x * d.x, uv = d.x * d.y, vv = d.y * d.y;
      row[6] = uu * d.x, row[7] = uu * d.y, row[8] = vv * d.x, row[9] = vv * d.y;
      row[10] = uu * uu, row[11] = uu * uv, row[12] = uu * vv, row[13] = uv * vv, row[14] = vv * vv;
      return true;
    }
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
  NormalEquations<kCurvatureUnknowns> quadric_;
  NormalEquations<kQuarticUnknowns> quartic_;
  Row solution_{};
  double radius_ = 1;
  CurvatureSurface surface_ = CurvatureSurface::quadric;
};

}  // namespace sansmesh::inline v1::detail
