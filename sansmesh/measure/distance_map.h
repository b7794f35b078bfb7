// Inspection map: deviations of a part from its reference surface.
#pragma once

#include <array>
#include <cstdint>
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

/// Distances for a picture of a cloud: of each point the median over the points whose closest points are within
/// `radius` (length) of its own, at most 64, on the same side if there are normals. The outermost points, which cover
/// the others in a picture, then show the typical distance of their place rather than their own noise.
std::vector<float> local_medians(const TriangleMesh& points, const DistanceMap& map, double radius);

}  // namespace sansmesh::inline v1
