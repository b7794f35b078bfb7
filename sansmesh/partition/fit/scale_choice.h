// Chooses the scale and degree of the best fit for each part of the surface.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/partition/fit/sample_tree.h"
#include "sansmesh/partition/fit/trial_fits.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Least mean number of samples in a sample's cell on the finest level that is tried. Errors of clean samples are
/// smallest between 3 and 5; fewer samples cost more and cause more handles in rough regions.
inline constexpr double kLeastCompany = 5;

/// Noise of the cloud that was used for the scales, from 0: hardly any, to 1: as much as the spacing. 0 also if the
/// options set the size of supports.
float noisiness(const ScaleBasis& basis);

/// Creates the levels of the tree that it needs. `diagonal`: diagonal of the samples' bounding box. Throws DataError if
/// no block can be fitted.
ScaleChoice choose_scales(SampleTree& tree, const PartitionOptions& options, double diagonal, Progress& progress);

/// Level and Morton code of a block.
struct BlockKey {
  int level;
  std::uint64_t code;
};

/// The same below some blocks (which do not overlap), with the noise and supports of the whole cloud from `basis`. The
/// tree has the cells of the whole cloud's tree, down to the finest tried level; it need not hold samples farther than
/// a few edges from those blocks. With the options of the whole fit and all samples, the result is the leaves of that
/// fit below those blocks.
ScaleChoice choose_scales_below(const SampleTree& tree, const PartitionOptions& options, const ScaleBasis& basis,
                                std::span<const BlockKey> roots, Progress& progress);

}  // namespace sansmesh::inline v1
