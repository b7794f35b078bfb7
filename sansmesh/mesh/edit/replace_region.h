// Replaces a changed region of a mesh by the corresponding part of another mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct RegionReplacement {
  bool done = false;  ///< everywhere
  /// Share of the patch's triangles in the sound region, outside the changes, that also occur in the mesh; 1 if there
  /// are none.
  double agreement = 0;
  std::size_t removed = 0, added = 0;  ///< numbers of triangles
  /// 1 for each change where the meshes could not be joined: the mesh is unchanged there.
  std::vector<std::uint8_t> spoiled;
};

/// `patch` is the new surface within the union of `sound` (which contains that of `changed` with a margin), made like
/// `mesh`, so that both have the same triangles away from the changes, up to `tolerance` in their vertices. Exchanges
/// connected pieces of differing triangles that touch a box of `changed`. The seam is thus identical on both sides, and
/// a closed manifold stays one. A piece that extends beyond `sound` stays unchanged. Does nothing if the agreement is
/// less than `least_agreement` (0..1). Attributes that the patch lacks become unknown in the new part
/// (AttributeTable::append). Boxes and both meshes are relative to the same origin.
RegionReplacement replace_region(TriangleMesh& mesh, const TriangleMesh& patch, const std::vector<Box3f>& sound,
                                 const std::vector<Box3f>& changed, float tolerance, double least_agreement = 0);

}  // namespace sansmesh::inline v1
