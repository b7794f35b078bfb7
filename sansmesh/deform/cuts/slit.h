// A mesh opened along one cut; shared by open_along_cuts and the faces along cuts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// An edge along which a mesh was opened, with its vertices on both sides (equal at the end of a slit), in the
/// direction of the triangle on the first side.
struct SlitEdge {
  std::array<std::uint32_t, 2> first, second;
  /// Third corners of the adjacent triangles, which distinguish the sides; kNoVertex: border of the mesh.
  std::uint32_t beside_first, beside_second;
};

struct Slit {
  std::vector<SlitEdge> edges;
  std::size_t doubled = 0;   ///< vertices
  std::size_t unopened = 0;  ///< triangles
};

/// Offset at which copies are evaluated, as a fraction of the distance to the centroid of the surrounding triangles.
constexpr float kAsideShare = 0.01f;

/// Sets the evaluation offset of vertices: attribute kCutSide, created if missing.
void set_cut_sides(TriangleMesh& mesh, const std::vector<std::uint32_t>& vertices, const std::vector<Vec3f>& offsets);

/// Opens the mesh along the last of the cuts; the others were applied before.
Slit open_slit(TriangleMesh& mesh, std::span<const std::shared_ptr<const Occluder>> cuts, int refinements);

}  // namespace sansmesh::inline v1
