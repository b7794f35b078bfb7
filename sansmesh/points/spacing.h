// How far apart the samples are.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Median over the cloud of the local sample spacing: the edge of the square that one sample stands for on the surface,
/// √(π r²/k) for the radius r of k neighbours. Unlike the distance to the nearest sample it does not shrink where scans
/// overlap or vertices coincide by accident, and exact duplicates count once. Unit of the input; 0 where no two finite
/// points differ. From a fixed subsample: O(n) with a small constant, the same for any number of threads.
double estimate_spacing(const PointSet& points);

/// The spacing around a sample is that of so many neighbours: a line of a scanner, whose own points are close together,
/// then has some of the next lines among them.
inline constexpr std::size_t kLocalNeighbours = 16;
/// It counts as no less than this share of the mean, and no more than so many times that (strays).
inline constexpr double kLeastLocal = 0.5, kMostLocal = 3;

/// From the squared distance to the last of those neighbours, and the mean spacing of all samples (length).
double local_spacing(double squared_distance, double mean);

}  // namespace sansmesh::inline v1
