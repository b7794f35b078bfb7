#include "sansmesh/field/level_set_curvature.h"

#include <cmath>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Points per batch; each needs seven evaluations.
constexpr std::size_t kBatch = 1 << 17;

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

void level_set_points(const ScalarField& field, std::span<const Vec3> x, double step, std::span<LevelSetPoint> result) {
  if (!(step > 0)) throw ArgumentError("level sets: the step must be a positive length");
  std::vector<Vec3> at, gradients;
  std::vector<double> values;
  for (std::size_t first = 0; first < x.size(); first += kBatch) {
    const std::size_t n = std::min(kBatch, x.size() - first);
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
