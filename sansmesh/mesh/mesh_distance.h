// Distances between two surfaces.
#pragma once

#include <cstddef>
#include <string>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct DistanceOptions {
  /// Samples per mesh, distributed evenly over its area, 1..2^31; clouds use every point. Maxima also include all
  /// vertices.
  std::size_t samples = 300000;
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Measures both directions. A mesh without triangles is a set of points: distances to its nearest point do not fall
/// below half of their spacing, however accurate the other side is. Origins may differ. Samples are reproducible for
/// any number of threads. Throws DataError if a side has no finite points.
SurfaceDistance measure_distance(const TriangleMesh& surface, const TriangleMesh& reference,
                                 const DistanceOptions& options, Progress& progress);

/// Distances of one direction as text, with their shares of the reference's diagonal.
std::string distance_words(const OneWayDistance& distance, const SurfaceDistance& both);

}  // namespace sansmesh::inline v1
