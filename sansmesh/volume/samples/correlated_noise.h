// Noise that neighbouring samples of a lattice share, as in tomography after its reconstruction kernel.
#pragma once

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_noise.h"

namespace sansmesh::inline v1 {

/// Estimates noise by the parabolas of estimate_noise(), but through samples some steps apart. `reach` of the result is
/// the least distance at which residuals are those of independent noise: of neighbours at that distance they are
/// opposite, and at all greater ones unrelated. Structure also ends at some distance, so noise is only found if the
/// residuals are normal deviates, hardly larger at greater distances, and small beside the data: above 0.35 of their
/// deviation they are noise in part, at 0.5 not at all. Not found for other grids, nor if noise is
/// independent from sample to sample.
SampleNoise estimate_correlated_noise(const SampledVolume& volume, const VolumeValues& values, Progress& progress);

}  // namespace sansmesh::inline v1
