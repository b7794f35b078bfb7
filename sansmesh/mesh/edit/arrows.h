// Arrow glyphs for vectors.
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
  /// Length of all arrows, > 0; default: `scale` times the length of the vector.
  std::optional<double> length = {};
  double scale = 1;            ///< arrow length per unit of the vectors, > 0
  double shaft_radius = 0.03;  ///< circumradius of the shaft, in arrow lengths, > 0
  double head_radius = 0.09;   ///< circumradius of the head, in arrow lengths, > shaft_radius
  double head_length = 0.3;    ///< length of the head, in arrow lengths, above 0 and below 1
  int sides = 8;               ///< sides of shaft and head, 3..256
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Makes an arrow from each position (in the world) along its vector: a closed, outward cylinder with a cone, of 3
/// sides + 1 vertices and 6 sides − 2 triangles, in order. Skips positions and vectors that are not finite, and zero
/// vectors. The volume is exactly that of the prism and the pyramid. Vertices have the normals of the round arrow and
/// the row of `attributes` of their position; `attributes` has a row per position or is empty. Throws ArgumentError for
/// invalid options and different numbers of positions, vectors and rows, DataError for more vertices than a mesh can
/// have.
TriangleMesh arrows(std::span<const Vec3> positions, std::span<const Vec3> vectors, const ArrowOptions& options = {},
                    const AttributeTable& attributes = {});

/// Ascending indices of a maximal set of vertices with pairwise distances of at least `spacing` (length, > 0), as
/// positions of arrows. Uses only finite vertices and, for meshes with triangles, only those that a triangle uses.
/// Independent of the number of threads.
std::vector<std::uint32_t> spread_vertices(const TriangleMesh& mesh, double spacing);

}  // namespace sansmesh::inline v1
