// Overlaps of a mesh with itself: components inside of each other, faces that cut through each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct ComponentOverlap {
  /// For each component the winding number of all other closed components around it, the median over some points just
  /// behind its faces: 0 outside of all, 1 inside of one that faces outward, or where the same body is there twice. 0
  /// for components that are not closed.
  std::vector<int> surrounding;
  std::size_t crossing_pairs = 0;       ///< pairs of triangles that cut through each other
  std::size_t crossing_components = 0;  ///< components with a triangle that cuts one of another component
};

/// `component` numbers the component of each triangle, `closed` marks the components that are closed. Winding numbers
/// count the faces above a point, with their direction. Deterministic for any number of threads; about n log n, and
/// what pairs of triangles there are whose boxes overlap. Memory linear in the size of the mesh.
ComponentOverlap component_overlap(const TriangleMesh& mesh, std::span<const std::uint32_t> component,
                                   std::span<const std::uint8_t> closed);

}  // namespace sansmesh::inline v1
