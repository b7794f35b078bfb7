// The part of a mesh that lies in a box, or outside, or where a function of its vertices is not negative.
#pragma once

#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Cuts the triangles along the faces of the box (relative to the mesh's origin) and drops what is outside: the result
/// ends there in straight borders. Attributes of vertices are interpolated, those of triangles go to their parts.
void clip_mesh(TriangleMesh& mesh, const Box3f& box);

/// Cuts the triangles along the faces of the box (as clip_mesh) and drops what is inside. Triangles away from the box
/// stay as they are.
void cut_out_box(TriangleMesh& mesh, const Box3f& box);

/// Keeps what is above the contour where `heights`, one for each vertex and linear in between, pass zero. Vertices from
/// which an edge crosses the contour within the share `snap` of its length (0..0.5) are moved onto it, those below no
/// farther than they are from a vertex above: without slivers along the border.
void clip_mesh(TriangleMesh& mesh, std::vector<float> heights, float snap);

}  // namespace sansmesh::inline v1
