// Vectors as arrows.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct ArrowOptions {
  /// Of every arrow, > 0 (length); default: `scale` times that of its vector.
  std::optional<double> length = {};
  double scale = 1;            ///< > 0 (length per unit of the vectors)
  double shaft_radius = 0.03;  ///< of the corners, in lengths of the arrow, > 0
  double head_radius = 0.09;   ///< the same, > shaft_radius
  double head_length = 0.3;    ///< in lengths of the arrow, above 0 and below 1
  int sides = 8;               ///< of shaft and head, 3..256
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// An arrow from each position (in the world) along its vector: a cylinder with a cone before it, closed, outward, of
/// 3 sides + 1 vertices and 6 sides − 2 triangles, one after the other. Where positions or vectors are not finite,
/// or the vector is zero, there is none. The volume is exactly that of the prism and the pyramid. Vertices have the
/// normals of the round arrow and their position's row of `attributes`, which has one for each or is empty. Throws
/// ArgumentError for bad options and different numbers of positions, vectors and rows, DataError for more vertices
/// than a mesh can have.
TriangleMesh arrows(std::span<const Vec3> positions, std::span<const Vec3> vectors, const ArrowOptions& options = {},
                    const AttributeTable& attributes = {});

/// Numbers, ascending, of vertices no two of which are nearer than `spacing` (length, > 0), such that any other one is
/// nearer than that to one of them: places for arrows. Only vertices that are finite and, of a mesh with triangles,
/// used by one. The same for any number of threads.
std::vector<std::uint32_t> spread_vertices(const TriangleMesh& mesh, double spacing);

}  // namespace sansmesh::inline v1
