// Triangles of marching tetrahedra.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace sansmesh::inline v1 {

/// The zero set in a positively oriented simplex as one or two triangles, with normals towards positive values. Bit i
/// of `inside`: corner i is negative. `crossing(i, j)` returns the vertex between negative corner i and positive corner
/// j; `emit(p, q, r)` receives the triangles.
template <class Crossing, class Emit>
void march_simplex(unsigned inside, const Crossing& crossing, const Emit& emit) {
  // Even permutations that put the inside corners first: one, two, or three with the outside corner last.
  static constexpr std::array<std::array<std::uint8_t, 4>, 16> kInsideFirst{{{0, 1, 2, 3},
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
  const auto [a, b, c, d] = kInsideFirst[inside];
  switch (std::popcount(inside)) {
    case 1: {
      const auto p = crossing(a, b), q = crossing(a, c), r = crossing(a, d);
      emit(p, q, r);
      break;
    }
    case 2: {
      const auto p = crossing(a, c), q = crossing(a, d), r = crossing(b, d), s = crossing(b, c);
      emit(p, q, r);
      emit(p, r, s);
      break;
    }
    case 3: {
      const auto p = crossing(a, d), q = crossing(b, d), r = crossing(c, d);
      emit(p, q, r);
      break;
    }
    default:
      break;
  }
}

}  // namespace sansmesh::inline v1
