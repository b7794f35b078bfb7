// Chooses the reconstruction of a volume from its grid, resolution and noise (tejada2008, ch. 7).
#pragma once

#include "sansmesh/reconstruction_options.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

/// The default method.
ReconstructionChoice choose_reconstruction(const SampledVolume& volume, const VolumeTraits& traits);

}  // namespace sansmesh::inline v1
