// Interface of volume fields that know a better function for their level sets.
#pragma once

#include <span>

#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Found by dynamic_cast. Steep fronts are flat on both sides, where their gradients say nothing about the surface.
class LevelField {
 public:
  virtual ~LevelField() = default;
  /// As VolumeField::evaluate, of a function g with {g = level} = {f = level}, which rises linearly through fronts.
  virtual void evaluate_level(double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const = 0;
};

}  // namespace sansmesh::inline v1
