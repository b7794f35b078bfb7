// Noise of the samples around blocks, estimated from the residuals of their fits.
#pragma once

#include "sansmesh/partition/fit/block_fit.h"
#include "sansmesh/partition/fit/trial_fits.h"

namespace sansmesh::inline v1 {

/// Sets the noise of the trials on the finest level, pooled over each block's neighbourhood.
void pool_noise(const BlockFitter& fitter, ScaleChoice& choice);

/// Sets the noise of the trials on the levels above the finest: the mean of their children.
void spread_noise(const BlockFitter& fitter, ScaleChoice& choice);

/// Sets the noise of all trials, the finest level and the variance of the cloud. Noise is the residual of the highest
/// affordable degree on the finest level whose balls are wide against it (other balls cut the noise off, and their fits
/// are meaningless); finer levels are given up. If no balls are so wide, the coarsest level with an estimate is used,
/// since coarser ones have none. `samples`: number of samples in blocks that were tried. Returns the evenness of the
/// noise: its standard deviation at the lowest tenth over the median.
double find_noise(const BlockFitter& fitter, double samples, ScaleChoice& choice);

}  // namespace sansmesh::inline v1
