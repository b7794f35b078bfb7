// Region that an edit changed: few boxes that cover many balls.
#pragma once

#include <vector>

#include "sansmesh/box.h"

namespace sansmesh::inline v1 {

/// At most 64 boxes whose union contains all given ones and little else. Each bounds the boxes whose centre is in one
/// cell of a grid over `cube`; the grid is as fine as that number allows. They may overlap.
std::vector<Box3f> changed_regions(const std::vector<Box3f>& boxes, const Box3f& cube);

}  // namespace sansmesh::inline v1
