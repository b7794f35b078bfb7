// Removal of vertices that seams do not need.
#pragma once

#include <cstddef>

#include "sansmesh/mesh/booleans/mesh_booleans.h"

namespace sansmesh::inline v1 {

struct ThinnedSeams {
  std::size_t removed = 0;   ///< vertices
  std::size_t inverted = 0;  ///< remaining faces that rounding has turned over or made flat
};

/// Moves new vertices into neighbours where the surface changes by at most `tolerance` (length): vertices within flat
/// regions and straight creases, and vertices closer together. Faces keep their orientation, the mesh its topology.
/// Given vertices stay, and faces that nothing cuts.
ThinnedSeams thin_seams(BooleanResult& mesh, double tolerance);

}  // namespace sansmesh::inline v1
