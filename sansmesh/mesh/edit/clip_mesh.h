// Clips a mesh by a box or by the sign of a function on its vertices.
#pragma once

#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Keeps the part inside a box (relative to the mesh's origin), with straight borders on its faces. Interpolates vertex
/// attributes; parts of triangles keep the attributes of the triangle.
void clip_mesh(TriangleMesh& mesh, const Box3f& box);

/// Removes the part inside a box (as clip_mesh). Triangles away from the box stay unchanged.
void cut_out_box(TriangleMesh& mesh, const Box3f& box);

/// Keeps the part where `heights`, one per vertex and linear in between, are positive. To avoid slivers along the
/// border, moves vertices onto the contour if an edge crosses it within the fraction `snap` (0..0.5) of its length;
/// vertices below move no farther than to a vertex above.
void clip_mesh(TriangleMesh& mesh, std::vector<float> heights, float snap);

}  // namespace sansmesh::inline v1
