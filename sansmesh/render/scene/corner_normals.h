// Normals for smooth shading that keep creases.
#pragma once

#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A unit normal for each corner of each triangle (3 · triangles; zero for triangles without area): the vertex normal
/// where the mesh has one that lies within 30° of the triangle's, else the mean, weighted by angle, of the normals of
/// those triangles around the vertex that lie within 35° of its own (its own where a vertex has more than 512
/// triangles). Corners must exist and be finite.
std::vector<Vec3f> corner_normals(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
