// Fitted functions as parts of solids.
#pragma once

#include <memory>

#include "sansmesh/csg/solid.h"
#include "sansmesh/function/fitted_function.h"

namespace sansmesh::inline v1 {

/// A function as a solid, in the coordinates of its samples. It knows how small the blocks are in which mesh_function
/// would cut it out, so that mesh_csg() need not be finer anywhere, nor coarser.
Solid function_solid(std::shared_ptr<const FittedFunction> function);

}  // namespace sansmesh::inline v1
