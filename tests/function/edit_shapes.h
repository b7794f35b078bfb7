// Shapes to edit, for the tests.
#pragma once

#include <cmath>
#include <variant>

#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh_options.h"
#include "support/clouds.h"

namespace sansmesh::test {

inline FittedFunction fitted(const PointSet& cloud, const FitOptions& options = {}) {
  Progress progress;
  return fit_surface_function(cloud, options, progress);
}

inline TriangleMesh meshed(const FittedFunction& function, const MeshOptions& options = {}) {
  Progress progress;
  return mesh_function(function, options, progress);
}

/// A sphere with bumps and dents all over it.
inline PointSet bumpy(std::size_t n) {
  const auto radius = [](const Vec3& d) {
    return 1 + 0.12 * std::sin(5 * d.x) * std::cos(6 * d.y + d.z) * std::sin(7 * d.z);
  };
  const auto value = [&](const Vec3& x) { return norm(x) - radius(normalized(x)); };
  PointSet cloud = sphere(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 d(cloud.positions[i]), p = d * radius(d);
    constexpr double h = 1e-5;
    const Vec3 g{value({p.x + h, p.y, p.z}) - value({p.x - h, p.y, p.z}),
                 value({p.x, p.y + h, p.z}) - value({p.x, p.y - h, p.z}),
                 value({p.x, p.y, p.z + h}) - value({p.x, p.y, p.z - h})};
    cloud.positions[i] = Vec3f(p), cloud.normals[i] = Vec3f(normalized(g));
  }
  return cloud;
}

inline PointSet colored(PointSet cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 7), 200});
  return cloud;
}

inline PointSet two_spheres() { return joined(sphere(6000), sphere(2000), 0.5f, {2, 0, 0}); }

inline Edit edit_in_ball(const Vec3& center, double radius, const decltype(Edit::action)& action) {
  Edit edit;
  edit.select.ball = {center, radius};
  edit.action = action;
  return edit;
}

}  // namespace sansmesh::test
