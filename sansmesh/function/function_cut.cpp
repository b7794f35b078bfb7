#include "sansmesh/function/function_cut.h"

#include <algorithm>
#include <utility>

#include "sansmesh/meshing/mesh_steps.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Least gap of the blocks over a requested mesh error: a coarse mesh is made from a finer one.
constexpr double kCoarseBlocks = 0.5;

}  // namespace

FunctionCut prepare_cut(const FittedFunction& function, const MeshOptions& options, double usual_error) {
  const PartitionOfUnity& field = function.field;
  const double mesh_error = options.mesh_error ? function.frame.from_input(*options.mesh_error) : usual_error;
  PolygonizeOptions meshing = meshing_options(options, mesh_error, field.data().options.sharp);
  meshing.seeds = field.seeds();
  const bool coarse = options.mesh_error.has_value();
  const double gap =
      coarse && options.enhance ? std::max(kCoarseBlocks * mesh_error, std::min(mesh_error, usual_error)) : mesh_error;
  return {mesh_error, std::move(meshing), field.mesh_blocks(gap, options.block_depth.value_or(BlockTree::kMaxLevel))};
}

}  // namespace sansmesh::inline v1::detail
