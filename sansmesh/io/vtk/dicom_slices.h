// DICOM slices as a grid in patient coordinates.
#pragma once

#include <string>

#include "sansmesh/grid_data.h"
#include "sansmesh/io/grids/vtk_module.h"

namespace sansmesh::inline v1::io {

/// Reads a slice, or all slices of a folder that VTK's reader recognises, into one block. Position, orientation and
/// order follow from the slices' positions and orientations in the patient (mm; x to the left, y to the back, z to the
/// head), not from their names. Slices at unequal distances make a rectilinear grid, slices shifted against each other
/// a curvilinear one. Slices without positions are stacked in the order of their names, with a note. Throws
/// std::runtime_error for folders without slices, several series in one folder, several slices at one position, and
/// slices that are truncated, compressed, not of 8 or 16 bits, or at non-finite positions.
void add_slices(const std::string& path, VtkSink& sink, GridData& data);

}  // namespace sansmesh::inline v1::io
