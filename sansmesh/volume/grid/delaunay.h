// Cells for points that have none.
#pragma once

#include <span>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The Delaunay tetrahedralisation of points that are finite and all different (Qhull; Barber, Dobkin & Huhdanpaa
/// 1996). The points are moved by 1e-7 of their mean spacing beforehand, each in a direction of its own that follows
/// from its number, so that there is one answer for points on a common sphere too (lattices are); tetrahedra that are
/// flat without that are left out. Throws DataError for fewer than four points, for points in a plane or on a line.
CellList delaunay_tetrahedra(std::span<const Vec3> points);

}  // namespace sansmesh::inline v1
