// Values of a volume, smoothed by what their noise asks for: the first step of every reconstruction.
#pragma once

#include <optional>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

struct SmoothedValues {
  VolumeValues values;
  std::vector<float> deviations;  ///< remaining deviation of each number (unit of the array); empty if unchanged
  double smoothing = 0;           ///< factor of the noise; 0: the values are unchanged to the bit
  double noise = 0;               ///< deviation of the noise (of the component with most); 0 if none was found
  bool too_many = false;          ///< noise was found in more samples than are smoothed unasked
};

/// `factor` as `smoothing` of VolumeReconstructionOptions: without it 1 if estimate_noise finds noise in at most four
/// million samples, otherwise 0. A factor above 0 smooths by the estimated bound even if it may not be noise. Values
/// may have any magnitude.
SmoothedValues smoothed_values(const SampledVolume& volume, VolumeValues values, std::optional<double> factor,
                               Progress& progress);

}  // namespace sansmesh::inline v1
