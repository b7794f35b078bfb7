// Writers of lattices.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1 {

/// Writes a block of kind GridKind::lattice with equal steps along each axis: .vti (VTK XML image data, all arrays of
/// points), .mhd, .mha (MetaImage) or .nrrd (only the first array of points). A .mhd has its numbers in a .raw of the
/// same name, which must not exist unless this .mhd names it. The file appears whole or not at all. Throws FileError
/// for other endings and if it cannot be written, ArgumentError for other blocks.
void write_volume(const std::string& file, const GridBlock& block);

/// Throws FileError early, before long computations, as check_writable does.
void check_volume_writable(const std::string& file);

}  // namespace sansmesh::inline v1
