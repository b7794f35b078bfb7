// Input of a reconstruction of a volume.
#pragma once

#include <memory>

#include "sansmesh/progress.h"
#include "sansmesh/reconstruction_options.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/reconstruction_coefficients.h"

namespace sansmesh::inline v1 {

/// The options are in range, and none that the method does not use.
struct ReconstructionInput {
  std::shared_ptr<const SampledVolume> volume;
  VolumeValues values;
  ReconstructionOptions options;
  Progress& progress;
  /// `options` are those above until the method puts in what it has chosen; notes about values are there already.
  ReconstructionReport& report;
  /// Methods that have some put them in here, or take those that are here already in place of a fit.
  ReconstructionCoefficients& coefficients;
};

}  // namespace sansmesh::inline v1
