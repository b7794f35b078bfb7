// Lattices of values as files.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1 {

/// Writes a block of kind GridKind::lattice with equal steps along each axis: .vti (VTK XML image data, all arrays of
/// points) or .mhd, .mha (MetaImage) and .nrrd (the first array of points alone; .mhd beside a .raw of the same name,
/// which must not be there unless this .mhd names it). The file appears whole or not at all. Throws FileError for other
/// endings and where it cannot be written, ArgumentError for other blocks.
void write_volume(const std::string& file, const GridBlock& block);

/// Throws FileError early, before long work, as check_writable does.
void check_volume_writable(const std::string& file);

}  // namespace sansmesh::inline v1
