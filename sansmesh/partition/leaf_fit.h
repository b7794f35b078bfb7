// From a chosen block to a support with its function. Internal to partition/.
#pragma once

#include <vector>

#include "sansmesh/partition/neighbour_walk.h"
#include "sansmesh/partition/scale_choice.h"

namespace sansmesh::inline v1 {

/// A support with its function; of a creased one, with the further pieces in the order in which they are joined.
struct FittedLeaf {
  LocalFunction function;
  std::vector<LocalFunction> more;
  Support support;
};

/// Reused from leaf to leaf; quickest where these follow the curve.
struct FitWorkspace {
  explicit FitWorkspace(const SampleTree& tree) : walk(tree) {}
  NeighbourWalk walk;
  Workspace block;
  std::vector<Vec3f> position, normal;
  std::vector<float> weight;
};

/// The function of a chosen block, of the degree of its trial.
FittedLeaf fit_leaf(const BlockFitter& fitter, const ScaleChoice& choice, const Leaf& leaf, FitWorkspace& ws);

/// Fills in foot and area of a support from its function: the patch of surface in its block, the cube [lower, +edge]³.
void place_patch(const LocalFunction& f, const Vec3f& lower, float edge, Support& support);

}  // namespace sansmesh::inline v1
