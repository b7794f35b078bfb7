// What is asked of a simplification.
#pragma once

#include <cstddef>
#include <span>

namespace sansmesh::inline v1 {

struct CollapseOptions {
  /// Accepted root mean square distance of a vertex from the planes of the triangles it stands for (length, > 0).
  double error = 0;
  /// Less than that for single vertices (length, as many as vertices): what they are merged with has the least of all.
  /// Empty: the same for all.
  std::span<const float> limits = {};
  /// Go on with larger and larger errors until there are no more triangles than this, or none can go. 0: do not.
  std::size_t triangles = 0;
  /// Leave the mesh as it is if only a smaller share than this of a sample of its vertices could go at first, 0..1:
  /// then the search would cost more than it gains.
  double least_gain = 0;
  /// Least shape 4√3 A / Σ l² (area A, edges l) of the triangles made: 1 equilateral, 0.56 with an angle of 20°, 0.3
  /// with one of 10°. Triangles that are worse already need not become better. 0..0.9.
  double least_shape = 0.5;
  /// First patch by patch (about 4000 vertices each), then what is left at their borders: several times faster for
  /// large meshes. But how the triangles of a part lie then depends on where the patches end, so that a part simplified
  /// by itself differs more from the same part of the whole. Not with `triangles`.
  bool in_patches = false;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
