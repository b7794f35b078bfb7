// A mesh opened along one cut: what open_along_cuts and the faces along cuts share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/deform/occluder.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// An edge along which a mesh was opened, with its vertices on both sides (the same at the end of a slit), in the
/// direction in which the triangle on the first side runs through it.
struct SlitEdge {
  std::array<std::uint32_t, 2> first, second;
  /// The third corners of the triangles there, which tell the sides apart; kNoVertex: the mesh ended here.
  std::uint32_t beside_first, beside_second;
};

struct Slit {
  std::vector<SlitEdge> edges;
  std::size_t doubled = 0;   ///< vertices
  std::size_t unopened = 0;  ///< triangles
};

/// How far from their place, as a share of the way to the middle of the triangles around, copies are looked at.
constexpr float kAsideShare = 0.01f;

/// The offset of a vertex that is looked at from beside its place: attribute kCutSide, made if there is none.
void set_cut_sides(TriangleMesh& mesh, const std::vector<std::uint32_t>& vertices, const std::vector<Vec3f>& offsets);

/// Opens the mesh along the last of the cuts, after those before it.
Slit open_slit(TriangleMesh& mesh, std::span<const std::shared_ptr<const Occluder>> cuts, int refinements);

}  // namespace sansmesh::inline v1
