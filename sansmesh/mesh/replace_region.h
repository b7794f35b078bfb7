// A mesh whose surface changed somewhere: the part that changed is taken from another mesh.
#pragma once

#include <cstddef>

#include "sansmesh/core/box.h"
#include "sansmesh/data/triangle_mesh.h"

namespace sansmesh {

struct RegionReplacement {
  bool done = false;  ///< false: the two could not be joined, and the mesh is as it was
  /// Share of the patch's triangles in the sound part, but off the change, that the mesh has too; 1 if there are none.
  double agreement = 0;
  std::size_t removed = 0, added = 0;  ///< triangles
};

/// `patch` is the new surface within `sound` (which holds `changed` well inside) made as `mesh` was, so that away from
/// the change the two have the same triangles, up to `tolerance` in their vertices. Where they have not, connected
/// pieces that touch `changed` are exchanged. What joins is thus the same on both sides: a closed manifold stays one.
/// Fails where a piece reaches out of `sound`. Attributes of the mesh that the patch has not are unknown in the new
/// part (AttributeTable::append). Boxes and both meshes are relative to the same origin.
RegionReplacement replace_region(TriangleMesh& mesh, const TriangleMesh& patch, const Box3f& sound,
                                 const Box3f& changed, float tolerance);

}  // namespace sansmesh
