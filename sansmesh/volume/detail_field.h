// mls-detail: robust local polynomials of adaptive degree, blended.
#pragma once

#include <memory>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/sampled_volume.h"
#include "sansmesh/field/volume_field.h"
#include "sansmesh/volume/reconstruction.h"
#include "sansmesh/volume/volume_locator.h"
#include "sansmesh/volume/volume_values.h"

namespace sansmesh {

/// The reconstruction `mls-detail` (docs/methods/volume-reconstruction.md). `locator` is one of `volume`. `options` are
/// valid; what they leave open is chosen, and told in `report`.
std::unique_ptr<VolumeField> make_detail_field(std::shared_ptr<const SampledVolume> volume,
                                               std::shared_ptr<const VolumeLocator> locator, VolumeValues values,
                                               const ReconstructionOptions& options, Progress& progress,
                                               ReconstructionReport* report);

}  // namespace sansmesh
