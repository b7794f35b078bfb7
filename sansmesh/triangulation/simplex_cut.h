// Zero set of a linear function in a simplex as simplices that agree on both sides of every face.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

namespace sansmesh::inline v1 {

/// Corner of a piece: the zero of the function between vertex `first`, where it is negative, and vertex `second`, where
/// it is positive.
using CutCorner = std::pair<std::uint8_t, std::uint8_t>;
template <int N>
using CutPiece = std::array<CutCorner, N>;

/// The (N − 1)-simplices of {f = 0} in the simplex v_0 … v_N, N = 2, 3 or 4. Bit i of `positive` is set if f(v_i) > 0,
/// else f(v_i) is negative. With k negative and m positive vertices the set is the product of a simplex of k and one of
/// m corners, here divided by staircases: sequences of pairs (negative, positive) in which each step advances one
/// member. The restriction to a face of the simplex is the cut of that face, so that pieces of neighbours agree if both
/// list their common vertices in the same order.
///
/// If (v_1 − v_0, …, v_N − v_0) is positively oriented, the corners c_0, … and a vector from negative to positive
/// values form the positively oriented (c_1 − c_0, …, c_{N−1} − c_0, vector): the sides of a line and triangles face
/// positive values. Otherwise the pieces are reversed.
template <int N>
std::span<const CutPiece<N>> simplex_cut(unsigned positive);

}  // namespace sansmesh::inline v1
