// Principal curvatures of a fitted quadric, with its normal and its distance from the point.
#pragma once

#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Curvatures that were fitted to the samples around a point.
struct FittedCurvatures : PrincipalCurvatures {
  Vec3f normal;      ///< unit normal of the fitted surface; the given normal unless `refit_normal`
  float offset = 0;  ///< signed distance to the fitted surface along the given normal; 0 unless `offset`
};

}  // namespace sansmesh::inline v1
