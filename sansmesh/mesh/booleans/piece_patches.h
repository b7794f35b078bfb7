// Connected regions of an arrangement and their place among the solids.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/data/boolean_expression.h"
#include "sansmesh/mesh/booleans/arrangement.h"

namespace sansmesh::inline v1 {

/// Pieces of one solid, connected by edges on no other triangle: each point of a patch is in the same solids.
struct PiecePatches {
  std::vector<std::uint32_t> of_piece;
  std::size_t count = 0;
};
PiecePatches find_patches(const SolidTriangles& in, const Arrangement& arrangement);

/// What becomes of a patch.
enum class PatchUse : std::uint8_t { dropped, kept, reversed };

struct PatchUses {
  std::vector<PatchUse> of_patch;
  /// Solids that are not `resolved`, but whose winding number beside a patch of theirs is not that of a simple solid.
  std::vector<std::uint32_t> tangled;
};

/// Whether each patch separates inside and outside of the expression: kept, if the inside is behind it. Of patches that
/// coincide one is kept. One exact ray per patch counts the triangles above it. A solid that is not `resolved` is
/// behind its own patches.
PatchUses use_patches(const SolidTriangles& in, const ExactSpace& space, const FaceBoxTree& tree,
                      const Arrangement& arrangement, const PiecePatches& patches, const BooleanExpression& expression);

}  // namespace sansmesh::inline v1
