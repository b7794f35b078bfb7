// Decides whether the values of a volume are reconstructed by their logarithm.
#pragma once

#include <string>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

struct LogarithmChoice {
  bool use = false;
  double decades = 0;  ///< between the hundredths of the smallest and of the largest values; 0 unless all are > 0
};

/// The logarithm is used for one component whose samples are all positive, if they span at least two decades without a
/// hundredth at both ends, and if samples are nearer to the geometric than to the arithmetic mean of their neighbours:
/// a linear function keeps its values. The means are compared in the logarithm, for some thousand samples.
LogarithmChoice choose_logarithm(const SampledVolume& volume, const VolumeValues& values);

/// log(f / unit) for all values. Throws DataError that names the array unless all are positive.
VolumeValues logarithm_of(VolumeValues values, double unit);

/// The power of two next to the largest value: the unit of the logarithm, with which scaled values have the same one.
double logarithm_unit(const VolumeValues& values);

}  // namespace sansmesh::inline v1
