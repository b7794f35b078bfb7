// Which reconstruction suits a volume, from its grid, its resolution and its noise (METHODS §8).
#pragma once

#include <string>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/reconstruction_options.h"
#include "sansmesh/volume/volume_traits.h"

namespace sansmesh::inline v1 {

struct ReconstructionChoice {
  std::string method = "mls-detail";
  std::string why;  ///< a sentence without an end
};

/// What is taken where nobody chose.
ReconstructionChoice choose_reconstruction(const SampledVolume& volume, const VolumeTraits& traits);

}  // namespace sansmesh::inline v1
