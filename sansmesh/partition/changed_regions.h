// Where an edit changed a function: few boxes around many balls.
#pragma once

#include <vector>

#include "sansmesh/box.h"

namespace sansmesh::inline v1 {

/// Boxes, at most 64, whose union holds all of those given and little else: each is around those of them that have
/// their middle in one cell of a grid over `cube`, which is as fine as that number allows. They may overlap.
std::vector<Box3f> changed_regions(const std::vector<Box3f>& boxes, const Box3f& cube);

}  // namespace sansmesh::inline v1
