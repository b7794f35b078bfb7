// Faces along cuts, which make what was opened closed again.
#pragma once

#include <cstddef>

#include "sansmesh/deform/planar_occluder.h"
#include "sansmesh/deform/slit.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Adds the part of the plane within a solid, on both sides of the cut, to its opened mesh. Where the cut ends within
/// the solid the two faces share their vertices along its border. Inner vertices carry what belongs to the nearest one
/// of the slit. `inward`: the triangles of the solid face inward, and so do the faces. Returns how many triangles were
/// added; 0: the slit does not bound anything.
std::size_t add_cut_faces(TriangleMesh& mesh, const Slit& slit, const PlanarOccluder& cut, double edge_length,
                          bool inward = false);

}  // namespace sansmesh::inline v1
