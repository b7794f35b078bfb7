// Fits the support and function of a chosen block.
#pragma once

#include <vector>

#include "sansmesh/partition/fit/neighbour_walk.h"
#include "sansmesh/partition/fit/scale_choice.h"

namespace sansmesh::inline v1 {

/// A support with its function; if creased, with further pieces in joining order.
struct FittedLeaf {
  LocalFunction function;
  std::vector<LocalFunction> more;
  Support support;
};

/// Buffers reused from leaf to leaf; fastest if leaves follow the Morton curve.
struct FitWorkspace {
  explicit FitWorkspace(const SampleTree& tree) : walk(tree) {}
  NeighbourWalk walk;
  Workspace block;
  LocalSamples narrow;  ///< samples of a fit that wider ones are compared with
  std::vector<Vec3f> position, normal;
  std::vector<float> weight;
};

/// Function of a chosen block, with the degree of its trial.
FittedLeaf fit_leaf(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf, FitWorkspace& ws);

/// Computes foot and area of a support from its function: the patch of surface in its block, the cube [lower, +edge]³.
void set_surface_patch(const LocalFunction& f, const Vec3f& lower, float edge, Support& support);

}  // namespace sansmesh::inline v1
