// Order of the corners of a tetrahedron that a surface crosses.
#pragma once

#include <array>
#include <cstdint>

namespace sansmesh::inline v1 {

/// For each set of inside corners (bit i for corner i) an even permutation that brings these corners to the front. Even
/// permutations keep the orientation of the tetrahedron, so the triangles of all sets have the same side outside.
inline constexpr std::array<std::array<std::uint8_t, 4>, 16> kInsideFirst{{{0, 1, 2, 3},
                                                                           {0, 1, 2, 3},
                                                                           {1, 0, 3, 2},
                                                                           {0, 1, 2, 3},
                                                                           {2, 0, 1, 3},
                                                                           {0, 2, 3, 1},
                                                                           {1, 2, 0, 3},
                                                                           {0, 1, 2, 3},
                                                                           {3, 0, 2, 1},
                                                                           {0, 3, 1, 2},
                                                                           {1, 3, 2, 0},
                                                                           {0, 3, 1, 2},
                                                                           {2, 3, 0, 1},
                                                                           {0, 2, 3, 1},
                                                                           {1, 3, 2, 0},
                                                                           {0, 1, 2, 3}}};

}  // namespace sansmesh::inline v1
