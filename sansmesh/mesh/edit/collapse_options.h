// Options of mesh simplification.
#pragma once

#include <cstddef>
#include <span>

namespace sansmesh::inline v1 {

/// Least shape for a number of triangles: the cost decides about all but degenerate ones. Long thin triangles are
/// nearest to cylinders.
constexpr double kLeastShapeOfNumber = 0.01;

struct CollapseOptions {
  /// Largest root mean square distance of a vertex from the planes of the triangles merged into it (length, > 0; not
  /// with `triangles`).
  double error = 0;
  /// Smaller limits of individual vertices (length, one per vertex), also with `triangles`; a merged vertex has the
  /// least of them. Empty: no further limits.
  std::span<const float> limits = {};
  /// Instead of `error`: collapse the cheapest edges until at most this number of triangles is left, or none can be
  /// removed. 0: off.
  std::size_t triangles = 0;
  /// Leave the mesh unchanged if less than this share (0..1) of a sample of its vertices can be removed initially: the
  /// search would cost more than it gains.
  double least_gain = 0;
  /// Least shape quality 4√3 A / Σ l² (area A, edges l) of new triangles: 1 equilateral, 0.56 with an angle of 20°, 0.3
  /// with an angle of 10°. Triangles that are already worse need not improve; with `triangles`, new ones may be as bad
  /// as the worst around the edge before. 0..0.9.
  double least_shape = 0.5;
  /// Simplify patches of about 4000 vertices first, then their borders: several times faster for large meshes. The
  /// triangles then depend on the patch borders, so that a part simplified separately differs more from the same part
  /// of the whole. Not with `triangles`.
  bool in_patches = false;
  /// Throws ArgumentError that names the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
