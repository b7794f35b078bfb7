// How well-shaped the triangles of a mesh are, and how much they enclose.
#pragma once

#include <cstddef>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// l_max P / (4 √3 S); infinite without an area.
double aspect_ratio(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace sansmesh::inline v1
