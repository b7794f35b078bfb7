// Numbers of VTK's arrays.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/attribute_table.h"

class vtkDataArray;

namespace sansmesh::inline v1::io {

/// The numbers of an array by rows, or of `rows` only.
AttributeValues values_of(vtkDataArray& array, const std::vector<std::uint32_t>* rows);

}  // namespace sansmesh::inline v1::io
