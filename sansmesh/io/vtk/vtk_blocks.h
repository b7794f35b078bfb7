// What VTK's readers make, as blocks of a grid.
#pragma once

#include "sansmesh/grid_data.h"
#include "sansmesh/io/grids/vtk_module.h"

class vtkDataArray;
class vtkDataObject;

namespace sansmesh::inline v1::io {

/// Appends the blocks of a data set, or of all those in a tree of them, and what there is to note. Throws
/// std::runtime_error with the cause where cells name points that are not there or arrays do not fit.
void add_blocks(vtkDataObject& object, const std::string& name, VtkSink& sink, GridData& data);

/// The numbers of an array, row after row; of some rows alone where these are given.
AttributeValues values_of(vtkDataArray& array, const std::vector<std::uint32_t>* rows);

/// Leaves out blocks of points or surfaces where there are others with volume; collects equal notes.
void tidy_blocks(GridData& data);

}  // namespace sansmesh::inline v1::io
