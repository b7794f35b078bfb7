// Builds a PointSet from the numbers of a file: chooses its origin and drops unusable points.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/input.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1::io {

/// Limit of coordinates: points beyond it are dropped like non-finite ones, because their squares would overflow a
/// float.
inline constexpr double largest_coordinate = kLargestCoordinate;

/// Origin of a cloud in `box`: per axis zero if coordinates are at most 4 diagonals of the box away from zero, else the
/// centre rounded to a power-of-two grid near the size of the box, so that float coordinates stay exact.
Vec3 choose_origin(const Box3& box);

/// The same with a selection of the positions: a few strays far away from nearly all others (a line of zeros among
/// survey coordinates) are ignored. Reorders `some`.
Vec3 choose_origin(const Box3& box, std::vector<Vec3>& some);

/// Checks that float coordinates relative to `origin` keep the resolution of the file: half of the last decimal if all
/// numbers have few decimals, else a hundredth of a unit. If they do not, tries an origin in the middle unless the
/// input prescribes one; a remaining loss is a warning. `some` is a representative selection of the positions, in world
/// coordinates.
void keep_resolution(const Input& in, std::span<const Vec3> some, Vec3& origin);

/// Throws FileError if the extent of `box` is below the input's smallest extent but not zero.
void check_extent(const Input& in, const Box3& box);

/// Sets origin and positions from at(i) -> Vec3 (world, double). Non-finite positions become NaN, positions too far
/// away infinite; `finish` removes both.
template <class At>
void store_positions(const Input& in, PointSet& points, std::size_t n, At&& at) {
  const auto usable = [](const Vec3& p) {
    return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
           std::abs(p.z) <= largest_coordinate;
  };
  const std::size_t chunk = 1 << 15;
  std::vector<Vec3> some;
  const std::size_t step = 1 + n / (1 << 16);
  for (std::size_t i = 0; i < n; i += step)
    if (const Vec3 p = at(i); usable(p)) some.push_back(p);
  if (in.origin) {
    points.origin = *in.origin;
  } else {
    const Box3 box = parallel_reduce(
        n, chunk, Box3{},
        [&](std::size_t first, std::size_t last) {
          Box3 b;
          for (std::size_t i = first; i < last; ++i) {
            const Vec3 p = at(i);
            if (usable(p)) b.extend(p);
          }
          return b;
        },
        [](Box3 a, const Box3& b) { return a.extend(b), a; });
    check_extent(in, box);
    points.origin = choose_origin(box, some);
  }
  keep_resolution(in, some, points.origin);
  points.positions.resize(n);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  parallel_for(0, n, chunk, [&](std::size_t i) {
    const Vec3 p = at(i);
    if (usable(p))
      points.positions[i] = Vec3f(p - points.origin);
    else
      points.positions[i] = is_finite(p) ? Vec3f{infinity, infinity, infinity} : Vec3f{nan, nan, nan};
  });
}

/// Last step of every reader: checks the triangles' indices, drops points that are not finite or too far away (with a
/// warning) and the triangles on them, normalises normals (zero if they have no direction) and removes attributes
/// without information. Throws FileError if no points remain or an index is out of range.
void finish(const Input& in, PointSet& points);

/// Marks the whole cloud as one scan from infinitely far away in direction `towards` (unit): parallel rays.
void set_scanner(PointSet& points, const Vec3& towards);

}  // namespace sansmesh::inline v1::io
