// Gradients at the samples of a volume by least squares.
#pragma once

#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1::detail {

/// All components of each sample: gradient of the polynomial of degree 2 through the sample that best fits two rings of
/// its star (weights: the inverse squared distance in its metric), of degree 1 where these do not determine degree 2.
/// For coplanar or collinear samples: within their plane or line. Exact for polynomials of the degree. Not for
/// lattices.
std::vector<Vec3> sample_gradients(const SampledVolume& volume, const VolumeValues& values);

}  // namespace sansmesh::inline v1::detail
