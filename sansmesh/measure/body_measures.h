// Measures of solids: area, volume, centre of mass, moments of inertia, smallest box.
#pragma once

#include "sansmesh/box.h"
#include "sansmesh/measure/smallest_box.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Measures the sewn mesh (sewn_mesh.h). Volume, centre and moments follow from the divergence theorem, exactly for the
/// polyhedron: cavities (components that face inward) are subtracted; overlaps count twice, and are reported
/// (`misplaced`, `crossing_pairs`). Deterministic for any number of threads. Throws DataError if no triangle has an
/// area.
SolidMeasures measure_solid(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
