// Parameters of extracting the mesh of a function.
#pragma once

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/polygonize/polygonize_options.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1::detail {

struct FunctionCut {
  double mesh_error;  ///< in the unit of the field
  PolygonizeOptions meshing;
  BlockTree blocks;
};

/// `usual_error`: default distance of mesh and surface (length of the field).
FunctionCut prepare_cut(const FittedFunction& function, const MeshOptions& options, double usual_error);

}  // namespace sansmesh::inline v1::detail
