// Descriptors of the surface around a sample that are invariant under rigid motions.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Three histograms of 11 bins each, with sum 100 (0 for samples without neighbours).
using PointFeature = std::array<float, 33>;

/// Fast point feature histograms [rusu2009]: angles between the normals of a sample and its neighbours within `radius`
/// (length, > 0) and their connecting line, combined with those of the neighbours weighted by distance. Invariant under
/// rigid motions, but not under a change of sign of the normals. Arrays of equal length, unit normals. Parallel,
/// independent of the number of threads.
std::vector<PointFeature> point_features(std::span<const Vec3> points, std::span<const Vec3> normals, double radius);

}  // namespace sansmesh::inline v1
