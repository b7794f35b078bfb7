// Faces along cuts, which close an opened mesh.
#pragma once

#include <cstddef>

#include "sansmesh/deform/cuts/planar_occluder.h"
#include "sansmesh/deform/cuts/slit.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Adds the part of the plane inside a solid, on both sides of the cut, to its opened mesh. Where the cut ends inside
/// the solid, the two faces share their vertices along its border. Inner vertices take the attributes of the nearest
/// slit vertex. `inward`: the triangles of the solid face inward, and so do the faces. Returns the number of added
/// triangles; 0: the slit bounds no area.
std::size_t add_cut_faces(TriangleMesh& mesh, const Slit& slit, const PlanarOccluder& cut, double edge_length,
                          bool inward = false);

}  // namespace sansmesh::inline v1
