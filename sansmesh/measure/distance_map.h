// Inspection map: deviations of a part from its reference surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Smallest default range, relative to the diagonal of the reference's box: smaller values are rounding.
inline constexpr double kSmallestRange = 1e-6;

/// Distances at the used vertices of a mesh, or at all points if there are no triangles. Parallel, with the same result
/// for any number of threads. Throws DataError if there are no finite points, ArgumentError for bad options.
DistanceMap distance_map(const TriangleMesh& part, const SignedDistance& reference, const DistanceMapOptions& options,
                         Progress& progress);

/// Colour of a distance: blue inside, white at 0, red outside, saturated at ±range; grey where left out.
std::array<std::uint8_t, 3> distance_color(float distance, double range);

/// Stores distances as the vertex attribute "quality" (a name known to mesh viewers; "distance" without triangles; NaN
/// where left out), and their colours, in the mesh.
void apply_map(TriangleMesh& part, const DistanceMap& map, double range);

}  // namespace sansmesh::inline v1
