// From the mesh of a function to the mesh of what edits made of it, where they changed it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The mesh of an edited function, from the mesh that mesh_function made of it before with the same options: only what
/// lies around `changed` (input coordinates, FunctionEditor::changed) is made anew, and joined where old and new have
/// the same triangles. The same goes for what lies around the few vertices that are off the surface elsewhere, as in a
/// mesh that is older than an edit. The whole mesh is made anew where that fails, where some of the surface is open,
/// and where the mesh turns out to be another one. `before` may have gone through a file.
TriangleMesh update_mesh(const FittedFunction& function, TriangleMesh before, std::span<const Box3> changed,
                         const MeshOptions& options, Progress& progress, MeshUpdate* update = nullptr);

/// How far a mesh is one of a function, whoever made it and with whatever triangles.
struct MeshMatch {
  std::size_t vertices = 0;  ///< that were looked at
  std::size_t on = 0;        ///< of them, those that lie on the surface
  double near = 0;           ///< what counts as on it (length, input)
  double farthest = 0;       ///< of them, distance from the surface, about (length, input)
  Vec3 farthest_at;          ///< (input)
  std::vector<Vec3> off;     ///< places of those that do not lie on the surface (input)
  /// Fewer are off than a mesh of the function has where it is steep.
  bool belongs() const { return vertices > 0 && 10 * on >= 9 * vertices; }
};

/// Looks at some tens of thousands of vertices, spread over the mesh. On the surface is what lies within the samples'
/// spacing, or twice their noise if that is more. Vertices in the boxes `except` (input coordinates) are not looked at.
MeshMatch match_mesh(const FittedFunction& function, const TriangleMesh& mesh, std::span<const Box3> except = {});

}  // namespace sansmesh::inline v1
