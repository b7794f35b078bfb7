// Smooths noisy samples of a volume on their own grid and keeps steps.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {

struct SmoothedSamples {
  std::vector<double> values;     ///< all components of each sample
  std::vector<float> deviations;  ///< the same: estimated remaining deviation, with the bias
};

/// Values of local polynomials of degree 1 and 2 about each sample over its 56, 136 or 270 nearest samples, with robust
/// weights that keep steps (tejada2008, 6.2: the fit about the sample does not interpolate it). Width and degree
/// minimise an unbiased estimate of the error, pooled over samples on the same side of steps; one candidate is the
/// sample itself (docs/methods/volume-noise.md). `factor` multiplies the noise; samples without noise stay unchanged.
SmoothedSamples smooth_samples(const SampledVolume& volume, const VolumeValues& values,
                               std::span<const StarMetric> metrics, const SampleNoise& noise, double factor,
                               Progress& progress);

}  // namespace sansmesh::inline v1
