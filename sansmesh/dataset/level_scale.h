// Scale of the values of level sets of volumes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// The norms > 0 of gradients.
std::vector<double> slopes_of(std::span<const Vec3> gradients);

/// Gradient norms > 0 (input units) at up to `most` of the points, which are in the coordinates of `frame`.
std::vector<double> slopes_at(const VolumeField& field, std::span<const Vec3> points, const LocalFrame& frame,
                              std::size_t most);

/// Range of (value − f) / slope for f in `values`. Without values there is no surface: positive.
ValueRange level_range(const ValueRange& values, double value, double slope);

}  // namespace sansmesh::inline v1
