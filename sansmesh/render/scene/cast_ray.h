// A ray, and where it meets a surface.
#pragma once

#include <limits>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct CastRay {
  Vec3f origin, direction;  ///< direction: unit vector
  float near = 0, far = std::numeric_limits<float>::infinity();
};

struct CastHit {
  bool hit = false;    ///< false: the rest has no meaning
  float distance = 0;  ///< along the ray
  Vec3 position;
  Vec3f normal;      ///< of the surface, unit, outward: away from the viewer where the surface is seen from behind
  float radius = 0;  ///< of the ball around that place: the scale of the surface there
};

}  // namespace sansmesh::inline v1
