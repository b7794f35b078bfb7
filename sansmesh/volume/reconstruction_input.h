// Input of a reconstruction of a volume.
#pragma once

#include <memory>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/reconstruction_coefficients.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// The options are valid and all used by the method.
struct ReconstructionInput {
  std::shared_ptr<const SampledVolume> volume;
  VolumeValues values;
  VolumeReconstructionOptions options;
  Progress& progress;
  /// `options` equal those above until the method writes its choices; notes about values are present already.
  VolumeReconstructionReport& report;
  /// Methods with coefficients store them here, or use those present instead of a fit.
  ReconstructionCoefficients& coefficients;
  bool logarithm = false;  ///< the values are logarithms of the array's
  bool noisy = false;      ///< the values had noise, which was smoothed
};

}  // namespace sansmesh::inline v1
