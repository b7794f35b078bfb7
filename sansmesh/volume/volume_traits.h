// The values of a volume, measured: resolved by their samples or not, noisy or not, with steps or without.
#pragma once

#include "sansmesh/progress.h"
#include "sansmesh/reconstruction_options.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

/// Deterministic, about a second at most. `values` are of the volume.
VolumeTraits measure_volume_traits(const SampledVolume& volume, const VolumeValues& values, Progress& progress);

}  // namespace sansmesh::inline v1
