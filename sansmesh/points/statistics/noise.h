// Estimates the noise of samples: their deviation from the surface.
#pragma once

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Robust estimate of the standard deviation of the samples from the surface, along its normal (input unit); 0 for
/// fewer than 20 distinct points. Fits quadrics to neighbourhoods of doubling size at a fixed subset of samples. With
/// growing size, residuals of noise stay constant, residuals of curvature grow cubically, residuals of creases
/// linearly; the scale with the least growth gives the noise. Designed to be accurate within a fifth if the noise
/// exceeds a hundredth of the spacing, and small against the spacing for clean samples.
double estimate_noise(const PointSet& points);

/// Same, with its reliability.
NoiseEstimate measure_noise(const PointSet& points);

}  // namespace sansmesh::inline v1
