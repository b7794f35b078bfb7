// A mesh whose surface changed somewhere: the part that changed is taken from another mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct RegionReplacement {
  bool done = false;  ///< everywhere
  /// Share of the patch's triangles in the sound part, but off the changes, that the mesh has too; 1 if there are none.
  double agreement = 0;
  std::size_t removed = 0, added = 0;  ///< triangles
  /// 1 for each change at which the two could not be joined, and the mesh is as it was.
  std::vector<std::uint8_t> spoiled;
};

/// `patch` is the new surface within the union of `sound` (which holds that of `changed` well inside) made as `mesh`
/// was, so that away from the changes the two have the same triangles, up to `tolerance` in their vertices. Where they
/// have not, connected pieces that touch a box of `changed` are exchanged. What joins is thus the same on both sides: a
/// closed manifold stays one. A piece that reaches out of `sound` stays as it is. Nothing is done where agreement is
/// less than `least_agreement` (0..1). Attributes of the mesh that the patch has not are unknown in the new part
/// (AttributeTable::append). Boxes and both meshes are relative to the same origin.
RegionReplacement replace_region(TriangleMesh& mesh, const TriangleMesh& patch, const std::vector<Box3f>& sound,
                                 const std::vector<Box3f>& changed, float tolerance, double least_agreement = 0);

}  // namespace sansmesh::inline v1
