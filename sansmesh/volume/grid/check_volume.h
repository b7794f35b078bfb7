// Validates volumes that do not come from assemble_volume.
#pragma once

#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

/// Throws DataError that names the defect unless array sizes match, sample and corner numbers are valid, positions are
/// finite, axes ascend, and stars are ascending lists. Does not check volumes and overlaps of cells. Runs in parallel.
void check_volume(const SampledVolume& volume);

}  // namespace sansmesh::inline v1
