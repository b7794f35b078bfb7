// The robust adaptive partition of unity as published (tejada2008, 4.4.3; polizelli, 3): a tree of blocks from the top
// down, which fit and mesh share. docs/methods/paper-partition.md compares it with the default method.
//
// A block with N samples in its support, the ball of `support` circumscribed radii around it:
//   (i)   2 · 3 ≤ N ≤ 1000: if a normal deviates by 90° or more from the mean, there are two sheets, and the block is
//         subdivided (ohtake2003). Otherwise the degree increases from 1 until the error is within the threshold, as
//         far as the number of samples and their coverage of the support allow. If the error stays too large, the block
//         is subdivided; but for N < 100 only if its children would not be worse.
//   (ii)  N < 6: the least-squares plane of the sample nearest to the centre and its neighbours, 20 in all; if it
//         deviates by more than π/6 from their mean normal, the plane of that normal.
//   (iii) N > 1000: subdivided without a fit.
// On the deepest level every block takes its best fit. Blocks that only balance subdivides keep their function.
#pragma once

#include "sansmesh/fit_options.h"
#include "sansmesh/partition/paper/paper_options.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Fits points with oriented normals. Throws DataError for fewer than 4 points or a cloud without extent, ArgumentError
/// for options out of range. `sorted`, if given, receives the points in the order of the Morton curve of the root cube,
/// as in fit_partition_of_unity().
PartitionOfUnity fit_paper_partition(PointSet points, const PaperOptions& options, Progress& progress,
                                     PointSet* sorted = nullptr, PaperReport* report = nullptr);

}  // namespace sansmesh::inline v1
