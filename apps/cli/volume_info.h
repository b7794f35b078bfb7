// What `info` says of a volume.
#pragma once

#include "console.h"
#include "volume_input.h"

namespace sansmesh::cli {

/// Grid, samples, spacing, what was mended, and every array. Throws FileError.
void run_volume_info(const VolumeInput& input, Console& console);

}  // namespace sansmesh::cli
