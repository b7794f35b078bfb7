// The zero set of a linear function in a simplex, cut into simplices in the same way from both sides of every face.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

namespace sansmesh::inline v1 {

/// A corner of a piece: the point where the function is zero between vertex `first`, where it is negative, and vertex
/// `second`, where it is positive.
using CutCorner = std::pair<std::uint8_t, std::uint8_t>;
template <int N>
using CutPiece = std::array<CutCorner, N>;

/// The (N − 1)-simplices that {f = 0} consists of in the simplex v_0 … v_N, N = 2, 3 or 4; bit i of `positive` says
/// that f(v_i) > 0, else it is negative. With k negative and m positive vertices the set is the product of a simplex of
/// k and one of m corners, here cut by staircases: pairs (negative, positive) of which one step changes one member to
/// the next. Faces of the simplex are cut as these by themselves, so that pieces of neighbours fit together if both
/// list their common vertices in the same order.
///
/// Of a simplex whose (v_1 − v_0, …, v_N − v_0) is positively oriented, the corners c_0, … and a vector from negative
/// to positive form the positively oriented (c_1 − c_0, …, c_{N−1} − c_0, vector): the sides of a line and triangles
/// look towards positive values. Of others the pieces are turned round.
template <int N>
std::span<const CutPiece<N>> simplex_cut(unsigned positive);

}  // namespace sansmesh::inline v1
