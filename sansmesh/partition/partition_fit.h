// From samples to a partition of unity.
#pragma once

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Fits to points with oriented normals. Throws DataError for fewer than 4 points or a cloud without extent,
/// ArgumentError for options out of range. `sorted`, if given, receives the points along the Morton curve of the root
/// cube, the order in which a refit wants them: origin, positions, normals and colours. Points that are moved in are
/// sorted in place: there is no second copy of them.
PartitionOfUnity fit_partition_of_unity(PointSet points, const PartitionOptions& options, Progress& progress,
                                        PointSet* sorted = nullptr);

}  // namespace sansmesh::inline v1
