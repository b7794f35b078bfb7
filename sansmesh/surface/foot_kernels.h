// Kernel of blended paraboloids, for groups of sixteen points.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

/// A local approximation of a surface for the kernel, one cache line. Its value at x_i + d is ⟨n, d⟩ − dᵀBd.
struct alignas(64) Paraboloid {
  float x, y, z;          ///< x_i, relative to the group's centre
  float inverse_support;  ///< 1 / R² of the weight (1 − d²/R²)⁴
  float nx, ny, nz;
  float inverse_reach;           ///< 1 / r², r: radius of the ball of the domain
  float xx, xy, xz, yy, yz, zz;  ///< B (1 / length)
};

/// Values and gradients at the points of a group; only lanes with inside > 0 are in a ball of the domain.
struct GroupHeights {
  alignas(64) float value[kGroup], x[kGroup], y[kGroup], z[kGroup], inside[kGroup];
};

/// `sheets`: ignore paraboloids that face away from the nearest one.
void blend_paraboloids(std::span<const Paraboloid> near, const PointGroup& group, bool sheets, GroupHeights& out);

}  // namespace sansmesh::inline v1::detail
