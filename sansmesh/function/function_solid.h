// Fitted functions as parts of solids.
#pragma once

#include <memory>

#include "sansmesh/csg/solid.h"
#include "sansmesh/function/fitted_function.h"

namespace sansmesh::inline v1 {

/// A function as a solid, in the coordinates of its samples. It reports the block sizes of mesh_function, so that
/// mesh_csg() uses the same resolution everywhere.
Solid function_solid(std::shared_ptr<const FittedFunction> function);

}  // namespace sansmesh::inline v1
