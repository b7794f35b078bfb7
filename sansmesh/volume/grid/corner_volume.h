// Converts cell data to samples at cell corners, for methods that need corner samples.
#pragma once

#include <memory>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1::detail {

struct CornerSamples {
  std::shared_ptr<const SampledVolume> volume;
  VolumeValues values;
};

/// The input itself if samples are corners. A lattice of cell data gains two coordinates per axis, at its ends, where
/// values continue linearly. Any other volume keeps its cells and has samples at their corners: values of linear
/// functions fitted by least squares to the samples of the cells around each corner (and to their stars, ring by ring,
/// where these do not span space), weighted by the inverse squared distance in the local metric. Linear functions are
/// reproduced; the cell values are not interpolated.
CornerSamples corner_samples(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

/// The input itself if samples are corners. Cell data gain samples at the corners of faces without a matching cell on
/// the other side, with the values of corner_samples, so that the convex hull of the samples contains the volume. Stars
/// are not set.
CornerSamples with_surface_samples(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

}  // namespace sansmesh::inline v1::detail
