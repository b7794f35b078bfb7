// Writer of cells of any shape with values at their corners or in them: .vtu (VTK XML unstructured grid).
#pragma once

#include <span>
#include <string>

#include "sansmesh/attribute_table.h"
#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The arrays have a row per point and per cell. The file appears whole or not at all. Throws FileError for other
/// endings and if it cannot be written.
void write_cells(const std::string& file, std::span<const Vec3> points, const CellList& cells,
                 const AttributeTable& of_points, const AttributeTable& of_cells);

}  // namespace sansmesh::inline v1
