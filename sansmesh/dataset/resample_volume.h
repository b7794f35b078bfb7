// Resamples a field on a lattice, for programs that read only these.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// Points include both ends of the box. Arrays: `name` (float) and `inside` (uint8: 1 in the volume). Evaluates in
/// batches, with progress. Throws DataError if values exceed the range of floats.
GridBlock resample_volume(const VolumeField& field, const std::string& name, const ResampleOptions& options,
                          Progress& progress);

}  // namespace sansmesh::inline v1
