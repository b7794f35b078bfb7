// Meshes as parts of solids.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A copy of a mesh that bounds a solid: vertices and triangles, with the checks and repairs of mesh_solid. With
/// `overlaps`, parts may overlap each other; it receives whether they do.
TriangleMesh checked_solid(TriangleMesh mesh, std::vector<std::string>& warnings, bool* overlaps = nullptr);

/// Throws DataError like mesh_solid if parts overlap: such a mesh has faces, but no distance.
void require_no_overlaps(const TriangleMesh& mesh);

/// A checked mesh as a solid.
Solid solid_of_checked(TriangleMesh mesh, bool rounded);

/// A mesh as a solid whose field is the distance to its faces, `rounded` for offsets of it. Throws DataError, one line
/// with the remedy, if its faces bound no solid. Holes are closed by fans, and a mesh whose faces all point inward is
/// reversed; `warnings` reports both, and faces that intersect.
Solid mesh_solid(TriangleMesh mesh, bool rounded, std::vector<std::string>& warnings);

}  // namespace sansmesh::inline v1
