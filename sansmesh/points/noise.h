// How far the samples are off the surface.
#pragma once

#include <string>

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Robust estimate of the standard deviation of the samples off the surface, along its normal (unit of the input);
/// 0 with fewer than 20 different points. Quadrics are fitted to neighbourhoods of doubling size at a fixed subsample
/// of places: noise leaves the same residual at every size, curvature one that grows with its cube, creases one that
/// grows with it; the scale where the residual grows least tells the noise. Meant to be right within a fifth where the
/// noise exceeds a hundredth of the spacing, and small against the spacing for clean samples.
double estimate_noise(const PointSet& points);

/// The same, and how sure it is.
NoiseEstimate measure_noise(const PointSet& points);

}  // namespace sansmesh::inline v1
