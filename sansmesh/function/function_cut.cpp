#include "sansmesh/function/function_cut.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sansmesh/meshing/mesh_steps.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Least gap of the blocks over a requested mesh error: a coarse mesh is made from a finer one.
constexpr double kCoarseBlocks = 0.5;
/// Largest number of samples that are starting points.
constexpr std::size_t kMostSamples = 5000000;

/// The feet of the fits, and samples: a large fit may extend over several parts of a plane, or over a gap, and its foot
/// may be between its samples.
std::vector<Vec3> starting_points(const FittedFunction& function) {
  std::vector<Vec3> seeds = function.field.seeds();
  const PointSet& samples = *function.samples;
  for (std::size_t i = 0; i < samples.size(); i += 1 + samples.size() / kMostSamples)
    seeds.push_back(samples.origin + Vec3(samples.positions[i]));
  return seeds;
}

}  // namespace

FunctionCut prepare_cut(const FittedFunction& function, const MeshOptions& options, double usual_error) {
  const PartitionOfUnity& field = function.field;
  const double mesh_error = options.mesh_error ? function.frame.from_input(*options.mesh_error) : usual_error;
  PolygonizeOptions meshing = meshing_options(options, mesh_error, field.data().options.sharp);
  meshing.seeds = starting_points(function);
  const bool coarse = options.mesh_error.has_value();
  const double gap =
      coarse && options.enhance ? std::max(kCoarseBlocks * mesh_error, std::min(mesh_error, usual_error)) : mesh_error;
  return {mesh_error, std::move(meshing), field.mesh_blocks(gap, options.block_depth.value_or(BlockTree::kMaxLevel))};
}

}  // namespace sansmesh::inline v1::detail
