// Samples in cells brought to the corners of the cells, for methods that work in cells.
#pragma once

#include <memory>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1::detail {

struct CornerSamples {
  std::shared_ptr<const SampledVolume> volume;
  VolumeValues values;
};

/// The same where samples are corners. Of a lattice of samples in cells one of two more coordinates on each axis, its
/// ends, where values go on straight. Else a volume of the same cells whose samples are their corners: values are those
/// of straight functions fitted to the samples of the cells around each corner by least squares (and their stars, ring
/// by ring, where these do not span space), weighted by the inverse square of the distance in the local metric.
/// Straight functions are reproduced; values in the cells themselves are not interpolated.
CornerSamples corner_samples(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

/// The same where samples are corners. Of samples in cells a volume with more samples, at the corners of faces that
/// have no cell of the same corners on their other side, with the values of corner_samples: then the hull of the
/// samples holds the volume. Stars are not set.
CornerSamples with_surface_samples(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

}  // namespace sansmesh::inline v1::detail
