// Self-overlaps of a mesh: nested components and intersecting faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct ComponentOverlap {
  /// For each component the winding number of all other closed components around it, the median over some points just
  /// behind its faces: 0 outside all, 1 inside one that faces outward, or for a duplicate body. 0 for open components.
  std::vector<int> surrounding;
  std::size_t crossing_pairs = 0;       ///< pairs of intersecting triangles
  std::size_t crossing_components = 0;  ///< components with a triangle that intersects another component
};

/// `component`: component of each triangle; `closed`: marks closed components. Winding numbers are signed counts of the
/// faces above a point. Deterministic for any number of threads. Time: about n log n plus the number of pairs of
/// triangles with overlapping boxes; memory: linear in the size of the mesh.
ComponentOverlap component_overlap(const TriangleMesh& mesh, std::span<const std::uint32_t> component,
                                   std::span<const std::uint8_t> closed);

}  // namespace sansmesh::inline v1
