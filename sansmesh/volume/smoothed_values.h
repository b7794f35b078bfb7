// Values of a volume, smoothed by what their noise asks for: the first step of every reconstruction.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/sample_noise.h"

namespace sansmesh::inline v1 {

/// Noise of values of any magnitude: independent, correlated on lattices, or Rician. Lattices of two equal layers,
/// which stand for single layers, are examined as layers.
SampleNoise noise_of_values(const SampledVolume& volume, const VolumeValues& values, Progress& progress);

/// Whether that many samples are smoothed without being asked to: more take minutes.
bool smoothed_unasked(std::size_t samples);

struct SmoothedValues {
  VolumeValues values;
  std::vector<float> deviations;  ///< remaining deviation of each number (unit of the array); empty if unchanged
  double smoothing = 0;           ///< factor of the noise; 0: the values are unchanged to the bit
  double noise = 0;               ///< SampleNoise::deviation(); 0 if none was found
  const char* kind = "";          ///< kind of the noise, if it was found: SampleNoise::kind()
  bool found = false;             ///< noise was found, so `noise` is not only a bound
  bool too_many = false;          ///< noise was found in more samples than are smoothed unasked
};

/// `factor` as `smoothing` of VolumeReconstructionOptions: without it 1 if noise is found in at most four million
/// samples, otherwise 0. A factor above 0 smooths by the estimated bound even if it may not be noise. Values may have
/// any magnitude. `known`: noise_of_values() of the same values, if it is known.
SmoothedValues smoothed_values(const SampledVolume& volume, VolumeValues values, std::optional<double> factor,
                               Progress& progress, const SampleNoise* known = nullptr);

}  // namespace sansmesh::inline v1
