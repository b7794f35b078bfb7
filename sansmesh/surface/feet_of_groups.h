// Writes the foot points of groups to those of a batch: shared by all projections.
#pragma once

#include <span>

#include "sansmesh/field/projection.h"
#include "sansmesh/surface/candidates.h"

namespace sansmesh::inline v1::detail {

/// Calls kernel(group, candidates, mixed, feet of the group) for all groups of x. Points outside of the domain, points
/// that are not finite, and points whose foot is not finite keep their position and are undefined.
template <class Kernel>
void project_groups(const Candidates& candidates, std::span<const Vec3> x, std::span<FootPoint> feet,
                    const Kernel& kernel) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    feet[i] = {};
    feet[i].position = x[i];
  }
  candidates.for_each_group(x, [&](const PointGroup& group, std::span<const Candidate> chosen, bool mixed) {
    GroupFeet out;
    kernel(group, chosen, mixed, out);
    for (std::size_t k = 0; k < group.count; ++k) {
      const Vec3 p = Vec3(group.center) + Vec3(Vec3f{out.x[k], out.y[k], out.z[k]});
      const Vec3 n(Vec3f{out.nx[k], out.ny[k], out.nz[k]});
      if (!(out.inside[k] > 0) || !is_finite(p) || !is_finite(n)) continue;
      feet[group.slot[k]] = {
          p, n, static_cast<double>(out.xx[k]), static_cast<double>(out.xy[k]), static_cast<double>(out.yy[k]), true};
    }
  });
}

}  // namespace sansmesh::inline v1::detail
