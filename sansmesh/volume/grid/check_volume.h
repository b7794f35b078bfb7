// Whether samples are such as assemble_volume makes them: for those that come from elsewhere.
#pragma once

#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

/// Throws DataError, naming what is wrong, unless sizes of all arrays fit each other, all numbers of samples and
/// corners name some that there are, every position is finite, axes ascend and stars are ascending lists. Whether cells
/// have volumes or overlap is not looked at. Runs in parallel.
void check_volume(const SampledVolume& volume);

}  // namespace sansmesh::inline v1
