// How the mesh of a function is cut out of it; not part of the public interface.
#pragma once

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/polygonize/polygonize_options.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1::detail {

struct FunctionCut {
  double mesh_error;  ///< length of the field
  PolygonizeOptions meshing;
  BlockTree blocks;
};

/// `usual_error`: distance of mesh and surface where the options ask for none (length of the field).
FunctionCut prepare_cut(const FittedFunction& function, const MeshOptions& options, double usual_error);

}  // namespace sansmesh::inline v1::detail
