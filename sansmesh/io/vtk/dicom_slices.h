// Slices of DICOM as a grid in the patient's coordinates.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/io/grids/vtk_module.h"

namespace sansmesh::inline v1::io {

/// Reads a slice, or all of a folder that VTK's reader takes for slices, into one block: where and which way up they
/// lie follows from their positions and orientations in the patient (mm; x to the left, y to the back, z to the head),
/// their order from these too, not from their names. Slices at different distances make a rectilinear grid, such that
/// are shifted against each other a curvilinear one. Slices without positions are stacked in the order of
/// their names, with a note. Throws std::runtime_error for folders without slices, several series in one, several
/// slices at one place, and slices that are truncated, compressed, of other than 8 or 16 bits, or placed at no finite
/// numbers.
void add_slices(const std::string& path, VtkSink& sink, GridData& data);

}  // namespace sansmesh::inline v1::io
