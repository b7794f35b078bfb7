// Normals for smooth shading that keep creases.
#pragma once

#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A unit normal for each corner of each triangle (3 · triangles; zero for triangles without area). It is the vertex
/// normal if the mesh has one within 30° of the triangle's. Otherwise it is the angle-weighted mean of the normals of
/// triangles around the vertex within 35° of this triangle's (only its own if a vertex has more than 512 triangles).
/// Corners must exist and be finite.
std::vector<Vec3f> corner_normals(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
