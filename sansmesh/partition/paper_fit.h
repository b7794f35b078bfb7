// The robust adaptive partition of unity as its sources have it (tejada2008, section 4.4.3; polizelli, section 3): a
// tree of blocks from the top down, which fit and mesh share. What the default does otherwise, and why, is in
// docs/methods/paper-partition.md.
//
// A block with N samples in its support, the ball of `support` circumscribed radii around it:
//   (i)   2 · 3 ≤ N ≤ 1000: if a normal is 90° or more off the mean one, there are two sheets, and the block is
//         subdivided (ohtake2003). Else the degree rises from 1 until the error is within the threshold, as far as the
//         samples allow, by their number and by what they cover of the support. Is the error too large still, the
//         block is subdivided; but with N < 100 only if its children would not be worse.
//   (ii)  N < 6: the least-squares plane of the sample nearest to the centre and its neighbours, 20 in all; if it is
//   more
//         than π/6 off their mean normal, the plane of that.
//   (iii) N > 1000: subdivided without a fit.
// On the deepest level every block takes the best that it has. Blocks that only balance subdivides keep their function.
#pragma once

#include <cstddef>

#include "sansmesh/fit_options.h"
#include "sansmesh/partition/paper_options.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Fits to points with oriented normals. Throws DataError for fewer than 4 points or a cloud without extent,
/// ArgumentError for options out of range. `sorted`, if given, receives the points along the Morton curve of the root
/// cube, as fit_partition_of_unity() has it.
PartitionOfUnity fit_paper_partition(PointSet points, const PaperOptions& options, Progress& progress,
                                     PointSet* sorted = nullptr, PaperReport* report = nullptr);

}  // namespace sansmesh::inline v1
