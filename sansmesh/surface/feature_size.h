// Local feature size: distance of a surface to its medial axis.
#pragma once

#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/surface/surface_samples.h"

namespace sansmesh::inline v1 {

/// Local feature size at each sample (length): the distance to the medial axis, as the smaller of the radii of the
/// largest empty balls that touch the surface there from inside and outside. Found by shrinking balls (ma2012), then
/// made 1-Lipschitz among neighbours. Noise reduces it: balls stop shrinking if their contact is within two spacings.
/// At most half the diagonal of the cloud.
std::vector<float> estimate_feature_size(const SurfaceSamples& samples, Progress& progress);

}  // namespace sansmesh::inline v1
