// How far apart the samples are.
#pragma once

#include "sansmesh/data/point_set.h"

namespace sansmesh {

/// Median over the cloud of the local sample spacing: the edge of the square that one sample stands for on the surface,
/// √(π r²/k) for the radius r of k neighbours. Unlike the distance to the nearest sample it does not shrink where scans
/// overlap or vertices coincide by accident, and exact duplicates count once. Unit of the input; 0 where no two finite
/// points differ. From a fixed subsample: O(n) with a small constant, the same for any number of threads.
double estimate_spacing(const PointSet& points);

}  // namespace sansmesh
