// The inspection map: how far every place of a part lies from where it should.
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

/// Least range that is chosen by itself, of the diagonal of the reference's box: below it lies rounding.
inline constexpr double kSmallestRange = 1e-6;

/// Distances at the vertices of a mesh that triangles use, or at all points if there are no triangles. Parallel, the
/// same for any number of threads. Throws DataError if there are no finite points, ArgumentError for bad options.
DistanceMap distance_map(const TriangleMesh& part, const SignedDistance& reference, const DistanceMapOptions& options,
                         Progress& progress);

/// The colour of a distance: blue inside, white at 0, red outside, full at ±range; grey where it was left out.
std::array<std::uint8_t, 3> distance_color(float distance, double range);

/// Writes distances as the attribute "quality" of the vertices (left out: NaN; the name that viewers of meshes know; of
/// a mesh without triangles "distance") and their colours into the mesh.
void apply_map(TriangleMesh& part, const DistanceMap& map, double range);

}  // namespace sansmesh::inline v1
