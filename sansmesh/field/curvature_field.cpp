#include "sansmesh/field/curvature_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kCurvatureBatch = 4096;
/// Points per batch; each needs seven evaluations.
constexpr std::size_t kLevelSetBatch = 1 << 17;

void principal_curvatures(const Vec3 (&hessian)[3], LevelSetPoint& p) {
  const double slope = norm(p.gradient);
  if (!(slope > 0)) return;
  const Vec3 n = p.gradient / slope;
  Vec3 t, b;
  tangent_frame(n, t, b);
  const auto second = [&](const Vec3& u, const Vec3& v) {
    return (u.x * dot(hessian[0], v) + u.y * dot(hessian[1], v) + u.z * dot(hessian[2], v)) / slope;
  };
  const double tt = second(t, t), bb = second(b, b), tb = 0.5 * (second(t, b) + second(b, t));
  const double mean = 0.5 * (tt + bb), spread = std::hypot(0.5 * (tt - bb), tb);
  p.k1 = mean + spread;
  p.k2 = mean - spread;
}

}  // namespace

PrincipalCurvatures principal_curvatures_of(float xx, float xy, float yy, const Vec3f& x_axis, const Vec3f& y_axis) {
  const float mean = 0.5f * (xx + yy), half = 0.5f * (xx - yy), spread = std::hypot(half, xy);
  const float angle = 0.5f * std::atan2(xy, half), c = std::cos(angle), s = std::sin(angle);
  return {mean + spread, mean - spread, c * x_axis + s * y_axis, c * y_axis - s * x_axis, true};
}

LevelSetCurvature::LevelSetCurvature(const ScalarField& field, double step) : field_(field), step_(step) {
  if (!(step > 0) || !std::isfinite(step)) throw ArgumentError("curvature: the step must be a positive length");
}

void LevelSetCurvature::evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                                 std::span<PrincipalCurvatures> curvatures) const {
  if (x.size() != normals.size() || x.size() != curvatures.size())
    throw ArgumentError("LevelSetCurvature::evaluate: as many normals and results as points are needed");
  parallel_ranges(0, x.size(), kCurvatureBatch, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    std::vector<Vec3> at(4 * n), gradients(4 * n);
    std::vector<double> values(4 * n);
    std::vector<std::uint8_t> inside(4 * n);
    std::vector<std::array<Vec3, 2>> axes(n);
    for (std::size_t i = 0; i < n; ++i) {
      tangent_frame(Vec3(normals[first + i]), axes[i][0], axes[i][1]);
      for (std::size_t k = 0; k < 2; ++k) {
        at[4 * i + 2 * k] = x[first + i] + axes[i][k] * step_;
        at[4 * i + 2 * k + 1] = x[first + i] - axes[i][k] * step_;
      }
    }
    field_.evaluate_in_domain(at, values, gradients, inside);
    for (std::size_t i = 0; i < n; ++i) {
      curvatures[first + i] = {};
      std::array<Vec3, 4> unit;
      bool known = true;
      for (std::size_t k = 0; k < 4; ++k) {
        unit[k] = normalized(gradients[4 * i + k]);
        known = known && inside[4 * i + k] != 0 && squared_norm(unit[k]) > 0;
      }
      if (!known) continue;
      const Vec3 sum = unit[0] + unit[1] + unit[2] + unit[3];
      const double side = dot(sum, Vec3(normals[first + i])) < 0 ? -0.5 / step_ : 0.5 / step_;
      const Vec3 along = (unit[0] - unit[1]) * side, across = (unit[2] - unit[3]) * side;
      curvatures[first + i] =
          principal_curvatures_of(static_cast<float>(dot(along, axes[i][0])),
                                  static_cast<float>(0.5 * (dot(along, axes[i][1]) + dot(across, axes[i][0]))),
                                  static_cast<float>(dot(across, axes[i][1])), Vec3f(axes[i][0]), Vec3f(axes[i][1]));
    }
  });
}

void level_set_points(const ScalarField& field, std::span<const Vec3> x, double step, std::span<LevelSetPoint> result) {
  if (!(step > 0)) throw ArgumentError("level sets: the step must be a positive length");
  std::vector<Vec3> at, gradients;
  std::vector<double> values;
  for (std::size_t first = 0; first < x.size(); first += kLevelSetBatch) {
    const std::size_t n = std::min(kLevelSetBatch, x.size() - first);
    at.resize(7 * n), gradients.resize(7 * n), values.resize(7 * n);
    parallel_for(0, n, 1024, [&](std::size_t i) {
      for (std::size_t k = 0; k < 7; ++k) at[k * n + i] = x[first + i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        at[(1 + 2 * axis) * n + i][axis] += step;
        at[(2 + 2 * axis) * n + i][axis] -= step;
      }
    });
    field.query({.points = at}, {values, gradients});
    parallel_for(0, n, 1024, [&](std::size_t i) {
      LevelSetPoint& p = result[first + i] = {};
      const auto g = [&](std::size_t k) { return gradients[k * n + i]; };
      p.value = values[i];
      p.gradient = g(0);
      const double scale = 0.5 / step;
      const Vec3 hessian[3] = {(g(1) - g(2)) * scale, (g(3) - g(4)) * scale, (g(5) - g(6)) * scale};
      principal_curvatures(hessian, p);
    });
  }
}

}  // namespace sansmesh::inline v1
