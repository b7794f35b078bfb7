// Where a surface that was never meshed can be: in balls around its samples.
#pragma once

#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A union of balls that holds the whole surface (METHODS §4): rays need to look for it nowhere else. Arrays of equal
/// length; positions in the coordinates of the field (relative to the cloud's origin), radii positive.
struct BallUnion {
  std::vector<Vec3f> centers;
  std::vector<float> radii;
};

}  // namespace sansmesh::inline v1
