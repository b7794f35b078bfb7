// How far two surfaces are from each other.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct DistanceOptions {
  /// Samples on each mesh, spread evenly over its area, 1..2^31; of a cloud every point is compared. Maxima include all
  /// vertices as well.
  std::size_t samples = 300000;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Measures both ways. A mesh without triangles is a set of points, whose distance is that to the nearest point: it
/// does not fall below the half of their spacing, however good the other side is. Origins may differ. Samples are
/// placed by a fixed rule, so results repeat, for any number of threads. Throws DataError if a side has no finite
/// points.
SurfaceDistance measure_distance(const TriangleMesh& surface, const TriangleMesh& reference,
                                 const DistanceOptions& options, Progress& progress);

/// Distances of one way with their shares of the reference's diagonal, for people.
std::string distance_words(const OneWayDistance& distance, const SurfaceDistance& both);

}  // namespace sansmesh::inline v1
