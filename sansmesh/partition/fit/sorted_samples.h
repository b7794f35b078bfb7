// Root cube and sorted samples of a fit.
#pragma once

#include <span>

#include "sansmesh/box.h"
#include "sansmesh/partition/fit/sample_tree.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Sets origin and root cube of `data`; returns the box of the points. Throws DataError for fewer than 4 points,
/// without normals, or if all points coincide.
Box3f set_root_cube(const PointSet& points, PartitionData& data);

/// Level with about one sample in the finest occupied cells even where the cloud is densest.
int deepest_level(std::span<const Vec3f> positions, float edge);

/// Replaces the root cube, which contains `box`, by one of an edge 2^(k/4) whose corners are multiples of a sixteenth
/// of it: blocks below level 4 do not depend on the extreme samples. Of the four edges in each octave takes the one
/// with the smallest cells that hold this many samples: the mean number in the cell of a sample.
void snap_root_cube(const Box3f& box, std::span<const Vec3f> positions, double company, PartitionData& data);

/// Sorts the points along the Morton curve of the root cube, to the depth `data.basis.sort_depth`. Positions and
/// normals are moved out of `points`. `sorted`, if given, receives origin and colours; take_samples() adds the rest.
SampleTree sort_samples(PointSet& points, const PartitionData& data, PointSet* sorted);

/// Moves positions and normals of a tree that is no longer needed to `sorted`, if given.
void take_samples(SampleTree& tree, PointSet* sorted);

}  // namespace sansmesh::inline v1
