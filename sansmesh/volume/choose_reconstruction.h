// Which reconstruction suits a volume, from its grid, its resolution and its noise (METHODS §8).
#pragma once

#include "sansmesh/reconstruction_options.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

/// What is taken where nobody chose.
ReconstructionChoice choose_reconstruction(const SampledVolume& volume, const VolumeTraits& traits);

}  // namespace sansmesh::inline v1
