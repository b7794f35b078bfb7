// Gradients at the samples of a volume by least squares.
#pragma once

#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1::detail {

/// Components a sample: of the polynomial of degree 2 through the sample that is nearest to the samples of two rings of
/// its star (weights: the inverse square of the distance in its metric), of degree 1 where these do not determine one
/// of degree 2. Of a plane or a line of samples: along it. Exact for polynomials of the degree. Not for lattices.
std::vector<Vec3> sample_gradients(const SampledVolume& volume, const VolumeValues& values);

}  // namespace sansmesh::inline v1::detail
