// A mesh taken apart into smooth patches, the curves along which they meet at an angle, and the corners of these.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// What is known of the edges of a mesh whose vertices at the same place are one.
struct MeshEdges {
  std::size_t edges = 0;
  std::size_t open = 0;     ///< of one face
  std::size_t tangled = 0;  ///< of three faces or more, or of two that run through it in the same direction
};

struct MeshPatches {
  static constexpr std::uint32_t kSmooth = std::numeric_limits<std::uint32_t>::max();

  /// Corners of each triangle: the first vertices at their places.
  std::vector<Triangle> triangles;
  /// Unit normals of the triangles; zero where they have no area.
  std::vector<Vec3> normal;
  /// Patch of each triangle: connected over edges that are no creases.
  std::vector<std::uint32_t> patch;
  /// Of each edge (3 · triangle + k, from corner k to the next one) the curve that it belongs to; kSmooth: it lies
  /// inside of a patch.
  std::vector<std::uint32_t> curve;
  /// The triangle behind each edge; kSmooth where there is not one.
  std::vector<std::uint32_t> across;
  /// Of each vertex the curve through it, or, from `curves` on, the corner that it is; kSmooth: inside of a patch.
  std::vector<std::uint32_t> place;
  std::uint32_t patches = 0, curves = 0, corners = 0;
  MeshEdges edges;
  /// The edges of one face, as 3 · triangle + k.
  std::vector<std::uint32_t> open;

  /// Creases are edges whose faces' normals differ by more than this angle (degrees), and those that have not two
  /// faces.
  /// Curves shorter than `least_crease` (length) that end inside of a patch, or close, are none.
  MeshPatches(const TriangleMesh& mesh, double crease_angle, double least_crease = 0);
};

}  // namespace sansmesh::inline v1
