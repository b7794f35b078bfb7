// Triangle shapes and size of a mesh.
#pragma once

#include <cstddef>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Aspect ratio l_max P / (4 √3 S); infinite without an area.
double aspect_ratio(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace sansmesh::inline v1
