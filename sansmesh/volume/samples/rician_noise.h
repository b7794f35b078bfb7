// Noise of magnitudes of complex numbers, as in magnetic resonance: a Rician distribution, whose mean is above the
// signal where that is weak.
#pragma once

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_noise.h"

namespace sansmesh::inline v1 {

/// Deviation of the real and imaginary parts (unit of the array), from the background, where magnitudes have a Rayleigh
/// distribution: mean 1.91 deviations, skewness 0.63, and 0.66 of the deviation that `noise` has at strong signals. 0
/// if there is no such background, or some values are negative.
double rician_deviation(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                        const SampleNoise& noise);

/// Mean magnitude of a signal (>= 0) with noise; both in deviations of a part.
double mean_magnitude(double signal);
/// The signal with this mean magnitude; 0 below that of noise alone.
double signal_of_magnitude(double mean);

}  // namespace sansmesh::inline v1
