// From a fitted function to its mesh.
#pragma once

#include <cstddef>

#include "sansmesh/core/box.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/meshing/mesh_options.h"

namespace sansmesh {

/// The zero set of the function as a manifold mesh (closed unless it bounds no solid, was trimmed or cut by the box),
/// in the coordinates of the input. The report is written anew. Throws DataError if nothing of it is left,
/// ArgumentError for bad options.
TriangleMesh mesh_function(const SurfaceFunction& function, const MeshOptions& options, Progress& progress,
                           MeshReport* report = nullptr);

struct MeshUpdate {
  bool local = false;                  ///< false: the whole mesh was made anew
  std::size_t removed = 0, added = 0;  ///< triangles
};

/// The mesh of an edited function, from the mesh that mesh_function made of it before with the same options: only what
/// lies around `changed` (input coordinates, FunctionEditor::changed) is made anew, and joined where old and new have
/// the same triangles. Where that fails, and where some of the surface is open, the whole mesh is made anew. `before`
/// may have gone through a file.
TriangleMesh update_mesh(const SurfaceFunction& function, TriangleMesh before, const Box3& changed,
                         const MeshOptions& options, Progress& progress, MeshUpdate* update = nullptr);

/// Distance between mesh and surface worth aiming at, given what fitting learned: two fifths of the surface's own
/// error, but not so little that there are many more vertices than samples.
double default_mesh_error(const PartitionReport& report);

}  // namespace sansmesh
