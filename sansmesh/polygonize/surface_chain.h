// From marched triangles to a manifold: cancellation, separation of sheets that touch, and undoing of merges that fail.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Names a vertex of the marched surface: the crossing point on lattice edge (a inside, b outside), or, where a == b,
/// all crossing points merged at lattice vertex a.
struct ChainVertex {
  std::uint32_t a, b;
  friend bool operator==(const ChainVertex&, const ChainVertex&) = default;
};
using ChainTriangle = std::array<ChainVertex, 3>;

struct SurfaceChain {
  std::vector<ChainVertex> vertices;  ///< a name may occur twice: sheets that touched there were separated
  std::vector<Triangle> triangles;
  int rounds = 1;  ///< until no merge had to be undone
};

/// What is marched, in blocks that share lattice vertices.
struct ChainSource {
  using Flags = std::vector<std::uint8_t>;  ///< of each lattice vertex
  /// The oriented triangles (all together: a closed chain) for a choice of lattice vertices that merge; where `near` is
  /// not empty, at least those of all blocks that have a marked vertex.
  std::function<std::vector<ChainTriangle>(const Flags& merged, const Flags& near)> march;
  /// Marks all vertices of the blocks that have a marked one. Absent: all is one block.
  std::function<void(Flags& marked)> widen;
};

/// Unmerged marching tetrahedra are a manifold; merging may fold a sheet flat (pairs of opposite triangles, which
/// cancel), pinch it at a vertex (which is then doubled) or glue it along an edge: there the merge is undone and the
/// march repeated, around what was undone. `merged` is updated; empty means that nothing merges.
SurfaceChain make_surface_chain(const ChainSource& source, ChainSource::Flags& merged);

}  // namespace sansmesh::inline v1
