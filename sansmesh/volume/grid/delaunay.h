// Delaunay tetrahedralisation of scattered points.
#pragma once

#include <span>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The Delaunay tetrahedralisation of finite, distinct points (Qhull; barber). The points are first perturbed by 1e-7
/// of their mean spacing, in directions derived from their indices, so that cospherical points (as in lattices) have a
/// unique result; tetrahedra that are flat without the perturbation are removed. Throws DataError for fewer than four
/// points, and for coplanar or collinear points.
CellList delaunay_tetrahedra(std::span<const Vec3> points);

}  // namespace sansmesh::inline v1
