// Scale of the values of level sets of volumes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// As VolumeField::evaluate, of the function that a field has for this level set (LevelField), or of the field.
void evaluate_level(const VolumeField& field, double level, std::span<const Vec3> x, const VolumeFieldValues& wanted);

/// Gradient norms > 0 (input units) of that function at up to `most` of the points, which are in the coordinates of
/// `frame`.
std::vector<double> slopes_at(const VolumeField& field, double level, std::span<const Vec3> points,
                              const LocalFrame& frame, std::size_t most);

/// Range of (value − f) / slope for f in `values`. Without values there is no surface: positive.
ValueRange level_range(const ValueRange& values, double value, double slope);

}  // namespace sansmesh::inline v1
