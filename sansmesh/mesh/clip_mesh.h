// The part of a mesh that lies in a box.
#pragma once

#include "sansmesh/core/box.h"
#include "sansmesh/data/triangle_mesh.h"

namespace sansmesh {

/// Cuts the triangles along the faces of the box (relative to the mesh's origin) and drops what is outside: the result
/// ends there in straight borders. Attributes of vertices are interpolated, those of triangles go to their parts.
void clip_mesh(TriangleMesh& mesh, const Box3f& box);

}  // namespace sansmesh
