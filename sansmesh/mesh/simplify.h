// Fewer triangles for the same surface.
#pragma once

#include <cstddef>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/triangle_mesh.h"

namespace sansmesh {

struct SimplifyOptions {
  /// Accepted root mean square distance of a vertex from the planes of the triangles it stands for (length, > 0).
  double error = 0;
  /// Go on with larger and larger errors until there are no more triangles than this, or none can go. 0: do not.
  std::size_t triangles = 0;
  /// Leave the mesh as it is if only a smaller share than this of a sample of its vertices could go at first, 0..1:
  /// then the search would cost more than it gains.
  double least_gain = 0;
  /// Least shape 4√3 A / Σ l² (area A, edges l) of the triangles made: 1 equilateral, 0.56 with an angle of 20°, 0.3
  /// with one of 10°. Triangles that are worse already need not become better. 0..0.9.
  double least_shape = 0.5;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Collapses edges as long as the quadric error (Garland & Heckbert 1997, "Surface simplification using quadric error
/// metrics") stays below `error`, cheapest first among their surroundings, many at once. Topology, closedness and
/// manifoldness stay; no triangle turns by more than 60° at once; boundary vertices stay where they are. What belongs
/// to merged vertices becomes their mean weighted by area (attributes: as AttributeTable says); triangles that are left
/// keep their attributes. The same for any number of threads. Returns whether anything changed.
bool simplify_mesh(TriangleMesh& mesh, const SimplifyOptions& options, Progress& progress);

}  // namespace sansmesh
