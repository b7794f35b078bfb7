// What the surface around a sample is like, in numbers that do not change when it is moved.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Three histograms of 11 bins each, of sum 100 (0 where a sample has no neighbours).
using PointFeature = std::array<float, 33>;

/// Fast point feature histograms [rusu2009]: of the angles between the normals of a sample and its neighbours within
/// `radius` (length, > 0) and the line between the two, with those of the neighbours themselves, by distance. They are
/// the same wherever the surface lies and however it is turned; not if the normals' sign is. Arrays of equal length,
/// normals unit. Parallel, the same for any number of threads.
std::vector<PointFeature> point_features(std::span<const Vec3> points, std::span<const Vec3> normals, double radius);

}  // namespace sansmesh::inline v1
