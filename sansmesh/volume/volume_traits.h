// Measures traits of the values of a volume: resolution, noise, steps.
#pragma once

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// Deterministic, about a second at most. `values` belong to `volume`, and `noise` is their noise_of_values().
VolumeTraits measure_volume_traits(const SampledVolume& volume, const VolumeValues& values, const SampleNoise& noise,
                                   Progress& progress);

}  // namespace sansmesh::inline v1
