// From chosen blocks to supports with their functions, and from these to the arrays of PartitionData. Internal to
// partition/.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/partition/neighbour_walk.h"
#include "sansmesh/partition/scale_choice.h"

namespace sansmesh {

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

/// Place of a block along the Morton curve, with those of all levels.
inline std::uint64_t curve_position(int level, std::uint64_t code) { return code << (3 * (20 - level)); }

/// A support of old or new: its function, further pieces (those of old data are chained by `next` through `chain`,
/// those of a fitted leaf are in `more`).
struct LeafRef {
  const LocalFunction* function;
  const Support* support;
  const LocalFunction* chain;
  const std::vector<LocalFunction>* more;
};
LeafRef ref_of(const PartitionData& data, std::size_t support);
LeafRef ref_of(const FittedLeaf& leaf);

/// Supports in the order of the Morton curve as the arrays of `data`, and their sums in its report.
void assemble(std::span<const LeafRef> leaves, PartitionData& data);

/// Appends the further pieces of a support to its function and those of all others. Throws DataError where there are
/// more functions than links can name.
void append_pieces(std::size_t support, std::span<const LocalFunction> pieces, std::vector<LocalFunction>& functions);

/// The sums over the supports in the report of `data`.
void sum_up(PartitionData& data);

/// Gap that linear triangles of half a block's edge would leave on the surface in a cell of the tree (length).
float flatness_gap(const BlockFitter& fitter, const ScaleChoice& choice, int level, std::uint32_t cell);

/// A block with a crease, and all above and below it, are at most as flat as a chamfer of its lattice would be. Codes
/// and gaps of all levels; `edge` of the root cube.
void mark_crease(const std::vector<std::vector<std::uint64_t>>& code, std::vector<std::vector<float>>& gap, float edge,
                 int level, std::uint64_t block);

}  // namespace sansmesh
