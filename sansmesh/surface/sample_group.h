// Groups of nearby points and the samples whose supports reach them: the unit of evaluation of surfaces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/search/ball_tree.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Number of points evaluated together, one per lane; at least the widest SIMD width, so that groups do not depend on
/// it.
constexpr std::size_t kGroup = 16;
/// Weights exp(−ε d²/h²) are cut off at exp(−kGaussianEnd).
constexpr float kGaussianEnd = 12;

/// One sample for the kernels, one cache line; lengths relative to the group's centre.
struct alignas(64) Candidate {
  float x, y, z;
  float inverse_support;  ///< 1 / R², or ε / h² for Gaussians
  float nx, ny, nz;
  float weight;          ///< constant factor: the area of the sample
  float plane;           ///< ⟨x_i, n_i⟩
  float square;          ///< ‖x_i‖²
  float inverse_reach;   ///< 1 / r², r: radius of the ball of the domain
  float inverse_height;  ///< 1 / z², z: validity of formulas of higher order (distance from the surface)
  float mx, my, mz;      ///< coefficient of the iterated approximation: ⟨x, m⟩ − plane_m
  float plane_m;
};

/// Up to kGroup points relative to a centre, as a structure of arrays; unused lanes repeat the last point.
struct PointGroup {
  alignas(64) float x[kGroup], y[kGroup], z[kGroup];
  std::uint32_t slot[kGroup];  ///< index of each point in the batch
  std::size_t count = 0;
  Vec3f center;
};

/// Foot points of the points of a group.
struct GroupFeet {
  alignas(64) float x[kGroup], y[kGroup], z[kGroup];     ///< positions relative to the group's centre
  alignas(64) float nx[kGroup], ny[kGroup], nz[kGroup];  ///< unit normals
  alignas(64) float xx[kGroup], xy[kGroup], yy[kGroup];  ///< second derivatives of FootPoint
  alignas(64) float inside[kGroup];                      ///< > 0 in the balls of the domain
};

/// Divides a batch into groups whose boxes are at most `extent` wide and calls visit(group, box) for each. Sorts the
/// batch along a space-filling curve unless its order is already suitable; the groups depend on the batch only. Points
/// that are not finite are skipped.
template <class Visit>
void for_each_group(std::span<const Vec3> x, double extent, Visit&& visit);

/// Order of the points of a batch: sorted by cells of the given edge, or unchanged if they are few. Skips points that
/// are not finite.
void order_batch(std::span<const Vec3> x, double cell, std::vector<std::uint64_t>& order);

template <class Visit>
void for_each_group(std::span<const Vec3> x, double extent, Visit&& visit) {
  thread_local std::vector<std::uint64_t> order_of_thread;
  std::vector<std::uint64_t> order;
  order.swap(order_of_thread);  // `visit` may evaluate another surface
  order_batch(x, extent, order);
  PointGroup group;
  for (std::size_t first = 0; first < order.size();) {
    Box3 box;
    std::size_t last = first;
    for (; last < order.size() && last - first < kGroup; ++last) {
      Box3 grown = box;
      grown.extend(x[static_cast<std::uint32_t>(order[last])]);
      const Vec3 size = grown.size();
      if (last > first && std::max({size.x, size.y, size.z}) > extent) break;
      box = grown;
    }
    group.count = last - first;
    group.center = Vec3f(box.center());
    const Vec3 center(group.center);
    for (std::size_t k = 0; k < kGroup; ++k) {
      const auto i = static_cast<std::uint32_t>(order[std::min(first + k, last - 1)]);
      const Vec3f p(x[i] - center);
      group.slot[k] = i;
      group.x[k] = p.x, group.y[k] = p.y, group.z[k] = p.z;
    }
    Box3f around;
    around.extend(Vec3f(box.lower)), around.extend(Vec3f(box.upper));
    visit(group, around);
    first = last;
  }
  order.swap(order_of_thread);
}

}  // namespace sansmesh::inline v1::detail
