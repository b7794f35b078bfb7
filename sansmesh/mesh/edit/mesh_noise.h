// Noise of the vertices of a mesh, and their normals.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1::detail {

/// Standard deviation of the noise along the normals, in edge lengths, from the median: creases do not count. Applies
/// the difference to the mean of the neighbours twice, which removes planes and constant curvature. The neighbours of v
/// are neighbour[first[v] .. first[v + 1]]; vertices without any are not used.
double noise_in_edges(std::span<const Vec3> x, std::span<const Triangle> triangles,
                      std::span<const std::uint32_t> first, std::span<const std::uint32_t> neighbour);

/// Recomputes the normals of vertices that triangles use: area-weighted means.
void renew_normals(TriangleMesh& mesh);

}  // namespace sansmesh::inline v1::detail
