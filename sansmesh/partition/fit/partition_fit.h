// Fits a partition of unity to samples.
#pragma once

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Fits points with oriented normals. Throws DataError for fewer than 4 points or a cloud without extent, ArgumentError
/// for options out of range. `sorted`, if given, receives the points in the order of the Morton curve of the root cube,
/// which refit() requires: origin, positions, normals and colours. Moved points are sorted in place, without a second
/// copy.
PartitionOfUnity fit_partition_of_unity(PointSet points, const PartitionOptions& options, Progress& progress,
                                        PointSet* sorted = nullptr);

}  // namespace sansmesh::inline v1
