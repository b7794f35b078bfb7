// Handles as weighted points, seen from one point.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/deform/mls/deform_setup.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

struct WeightedNode {
  Vec3 q, p;
  double weight = 0;
  Vec3 slope;  ///< gradient of the weight with respect to the point
};

/// All nodes of all handles; weights are scaled so that the nearest handle has about its `weight`.
struct NodesFrom {
  std::vector<WeightedNode> nodes;
  std::size_t heaviest = 0;
  std::optional<Vec3> held;  ///< source of the point, if it is on a handle
};

/// base to the power alpha, with the same bits as in kernels.
double weight_power(double base, double alpha);

/// Distances below this are rounding errors.
double rounding_of(const Vec3& x, const Vec3& q);

/// The nodes as seen from x. `detours` has the summed detours around the cuts from each point handle; those of nodes of
/// segments are computed here.
void gather_nodes(const DeformSetup& setup, std::span<const std::shared_ptr<const Occluder>> cuts,
                  std::span<const Detour> detours, const Vec3& x, NodesFrom& found);

/// Sum over all cuts of the detours from one point.
void add_detours(std::span<const std::shared_ptr<const Occluder>> cuts, const Vec3& from, std::span<const Vec3> x,
                 std::span<Detour> sums, std::vector<Detour>& scratch);

}  // namespace sansmesh::inline v1::detail
