// What a solid amounts to: area, volume, centre of mass, moments of inertia, size.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/measure/smallest_box.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Of the sewn mesh (sewn_mesh.h). Volume, centre and moments by the divergence theorem, exactly for the
/// polyhedron: cavities (components that face inward) are subtracted, overlaps count twice, and are counted
/// (`misplaced`, `crossing_pairs`). Deterministic for any
/// number of threads. Throws DataError if there is no triangle with an area.
SolidMeasures measure_solid(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
