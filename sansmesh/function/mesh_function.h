// Extracts the mesh of a fitted function.
#pragma once

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The zero set of the function as a manifold mesh (closed unless it bounds no solid, was trimmed or cut by the box),
/// in the coordinates of the input. Overwrites the report. Throws DataError if the result is empty, ArgumentError for
/// invalid options.
TriangleMesh mesh_function(const FittedFunction& function, const MeshOptions& options, Progress& progress,
                           MeshReport* report = nullptr);

/// Whether that mesh is made by a walk (Mesher).
bool is_walked(const FittedFunction& function, const MeshOptions& options);

/// Recommended distance between mesh and surface: two fifths of the surface's own error, but large enough that there
/// are not many more vertices than samples.
double default_mesh_error(const PartitionReport& report);

}  // namespace sansmesh::inline v1
