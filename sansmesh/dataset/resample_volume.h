// A field on a lattice: what programs that know nothing else can use.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

struct ResampleOptions {
  /// Points along the longest side of the box, 2..4096; those of the others follow, so that steps are equal. Or points
  /// along x, y and z, 1..65536 each.
  std::vector<std::size_t> size = {128};
  std::optional<Box3> box;  ///< default: that of the volume
  bool gradients = false;   ///< also an array NAME_gradient of three numbers a component
  double outside = 0;       ///< value where the volume is not; may be NaN

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Points at both ends of the box and between: arrays `name` (float) and `inside` (uint8: 1 in the volume). In
/// batches, with progress. Throws DataError where values do not fit into floats.
GridBlock resample_volume(const VolumeField& field, const std::string& name, const ResampleOptions& options,
                          Progress& progress);

}  // namespace sansmesh::inline v1
