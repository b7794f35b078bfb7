// Converts VTK data sets to grid blocks.
#pragma once

#include "sansmesh/grid_data.h"
#include "sansmesh/io/grids/vtk_module.h"

class vtkDataObject;

namespace sansmesh::inline v1::io {

/// Appends the blocks of a data set, or of all data sets in a tree, with notes. Throws std::runtime_error with the
/// cause if cells refer to missing points or arrays do not fit.
void add_blocks(vtkDataObject& object, const std::string& name, VtkSink& sink, GridData& data);

/// Removes blocks of points or surfaces if others have volume; collects equal notes.
void tidy_blocks(GridData& data);

}  // namespace sansmesh::inline v1::io
