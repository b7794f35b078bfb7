// Limits of coordinates and extents. Within them, squares of relevant lengths neither overflow nor underflow.
#pragma once

namespace sansmesh::inline v1 {

/// Limits for clouds and meshes, whose positions are floats: largest coordinate, and least length of the longest side.
/// Squares of distances down to 10⁻⁷ of such a side are normal floats.
inline constexpr double kLargestCoordinate = 1e18, kSmallestExtent = 1e-12;

/// Limits for volumes. They are computed in double and stored as float after scaling.
inline constexpr double kLargestOfVolume = 1e36, kSmallestOfVolume = 1e-36;

}  // namespace sansmesh::inline v1
