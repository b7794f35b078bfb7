// Union of balls around samples: bounds a surface without a mesh.
#pragma once

#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Union of balls that contains the whole surface (tejada2008, 2.2.3 and 4.5), so that ray casting is confined to it.
/// Arrays of equal length; positions in the field's coordinates (relative to the cloud's origin), radii positive.
struct BallUnion {
  std::vector<Vec3f> centers;
  std::vector<float> radii;
};

}  // namespace sansmesh::inline v1
