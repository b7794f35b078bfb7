// Estimates the spacing of samples.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Median over the cloud of the local sample spacing: the edge of the square that one sample covers on the surface, √(π
/// r²/k) for the radius r of k neighbours. Unlike the distance to the nearest sample, it does not shrink where scans
/// overlap or vertices nearly coincide; duplicates count once. Input unit; 0 if no two finite points differ. From a
/// fixed subset: O(n) with a small constant, independent of the number of threads.
double estimate_spacing(const PointSet& points);

/// Number of neighbours for the local spacing: for a scanner with close points on each line, they include some of the
/// next lines.
inline constexpr std::size_t kLocalNeighbours = 16;
/// Limits of the local spacing relative to the mean (the upper one for stray samples).
inline constexpr double kLeastLocal = 0.5, kMostLocal = 3;

/// Local spacing from the squared distance to the last neighbour and the mean spacing of all samples (length).
double local_spacing(double squared_distance, double mean);

}  // namespace sansmesh::inline v1
