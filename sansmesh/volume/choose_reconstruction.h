// Chooses the reconstruction of a volume from its grid, resolution and noise (tejada2008, ch. 7).
#pragma once

#include <optional>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// The default method.
VolumeReconstructionChoice choose_reconstruction(const SampledVolume& volume, const VolumeTraits& traits,
                                                 std::optional<double> smoothing = {});

}  // namespace sansmesh::inline v1
