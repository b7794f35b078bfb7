// Turns marched triangles into a manifold: cancels folded pairs, separates touching sheets, undoes merges that fail.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Identifies a vertex of the marched surface: the crossing point on lattice edge (a inside, b outside) or, where a ==
/// b, all crossing points merged at lattice vertex a.
struct ChainVertex {
  std::uint32_t a, b;
  friend bool operator==(const ChainVertex&, const ChainVertex&) = default;
};
using ChainTriangle = std::array<ChainVertex, 3>;

struct SurfaceChain {
  std::vector<ChainVertex> vertices;  ///< an identifier may occur twice, where touching sheets were separated
  std::vector<Triangle> triangles;
  int rounds = 1;  ///< marching rounds until no merge had to be undone
};

/// Interface of the marched blocks, which share lattice vertices.
struct ChainSource {
  using Flags = std::vector<std::uint8_t>;  ///< one per lattice vertex
  /// Returns the oriented triangles (together a closed chain) for a choice of merging lattice vertices. If `near` is
  /// not empty, at least the triangles of all blocks that have a marked vertex.
  std::function<std::vector<ChainTriangle>(const Flags& merged, const Flags& near)> march;
  /// Marks all vertices of the blocks that have a marked one. Absent: all vertices are one block.
  std::function<void(Flags& marked)> widen;
};

/// Unmerged marching tetrahedra form a manifold. Merging may fold a sheet flat (pairs of opposite triangles, which
/// cancel), pinch it at a vertex (which is then doubled) or glue it along an edge; in the last case the merge is undone
/// and the march repeated around it. `merged` is updated; empty means that nothing merges.
SurfaceChain make_surface_chain(const ChainSource& source, ChainSource::Flags& merged);

}  // namespace sansmesh::inline v1
