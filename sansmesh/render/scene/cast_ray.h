// A ray and its intersection with a surface.
#pragma once

#include <limits>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct CastRay {
  Vec3f origin, direction;  ///< unit vector
  float near = 0, far = std::numeric_limits<float>::infinity();
};

struct CastHit {
  bool hit = false;    ///< false: the other fields are undefined
  float distance = 0;  ///< along the ray
  Vec3 position;
  Vec3f normal;      ///< unit surface normal, outward: away from the viewer if the surface is seen from behind
  float radius = 0;  ///< radius of the ball around the position: the local scale of the surface
};

}  // namespace sansmesh::inline v1
