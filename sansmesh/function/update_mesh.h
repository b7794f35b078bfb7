// Updates the mesh of a function in the regions that edits changed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Mesh of an edited function, from the mesh that mesh_function made of it before with the same options. Only the parts
/// around `changed` (input coordinates, FunctionEditor::changed) are remeshed, and joined where old and new have the
/// same triangles. So are parts around the few vertices that are off the surface elsewhere, as in a mesh that is older
/// than an edit. The whole mesh is remeshed if that fails, if some of the surface is open, or if the mesh is not one of
/// the function. `before` may have been written to and read from a file.
TriangleMesh update_mesh(const FittedFunction& function, TriangleMesh before, std::span<const Box3> changed,
                         const MeshOptions& options, Progress& progress, MeshUpdate* update = nullptr);

/// Agreement of a mesh with a function, for meshes of any origin.
struct MeshMatch {
  std::size_t vertices = 0;  ///< number of tested vertices
  std::size_t on = 0;        ///< number of those on the surface
  double near = 0;           ///< largest distance that counts as on the surface (length, input)
  double farthest = 0;       ///< approximate largest distance from the surface (length, input)
  Vec3 farthest_at;          ///< position of that vertex (input)
  std::vector<Vec3> off;     ///< positions of tested vertices off the surface (input)
  /// Fewer vertices are off than in a mesh of the function where it is steep.
  bool belongs() const { return vertices > 0 && 10 * on >= 9 * vertices; }
};

/// Tests some tens of thousands of vertices, spread over the mesh. A vertex is on the surface within the samples'
/// spacing, or within twice their noise if that is more. Vertices in the boxes `except` (input coordinates) are not
/// tested.
MeshMatch match_mesh(const FittedFunction& function, const TriangleMesh& mesh, std::span<const Box3> except = {});

}  // namespace sansmesh::inline v1
