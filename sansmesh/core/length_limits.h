// How large and how small things may be. Within these limits no square of a length that matters leaves its type.
#pragma once

namespace sansmesh::inline v1 {

/// Clouds and meshes, whose positions are floats: a coordinate at most, and the longest side at least. Squares of
/// distances of 10⁻⁷ of such a side still are normal floats.
inline constexpr double kLargestCoordinate = 1e18, kSmallestExtent = 1e-12;

/// Volumes, which are computed in double and end in float in a unit that suits them.
inline constexpr double kLargestOfVolume = 1e36, kSmallestOfVolume = 1e-36;

}  // namespace sansmesh::inline v1
