// Faces of a solid as a manifold.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/mesh/booleans/arrangement.h"

namespace sansmesh::inline v1 {

/// A face of the result: a piece with its final orientation.
struct KeptPiece {
  Triangle vertex;
  std::uint32_t triangle;  ///< the whole triangle
  bool reversed;
  bool cut;
};

/// Outward, of length 1.
Vec3 kept_normal(const SolidTriangles& in, const KeptPiece& face);

/// Faces that enclose a solid become a manifold. Where more than two meet at an edge, those on both sides of the same
/// part of the solid stay together: parts that touch are separate. Renumbers the vertices of the faces; vertices where
/// several fans of faces meet have a copy for each, and edges that remain equal receive a vertex in the middle, which
/// is appended to `positions`. Returns the former number of each vertex; nothing if the faces enclose no solid.
std::optional<std::vector<std::uint32_t>> make_manifold(const SolidTriangles& in, std::vector<Vec3>& positions,
                                                        std::vector<KeptPiece>& faces);

}  // namespace sansmesh::inline v1
