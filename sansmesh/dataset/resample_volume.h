// A field on a lattice: what programs that know nothing else can use.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// Points at both ends of the box and between: arrays `name` (float) and `inside` (uint8: 1 in the volume). In
/// batches, with progress. Throws DataError where values do not fit into floats.
GridBlock resample_volume(const VolumeField& field, const std::string& name, const ResampleOptions& options,
                          Progress& progress);

}  // namespace sansmesh::inline v1
