// Corner tests and area vectors of indexed triangles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Whether no corner is repeated.
inline bool has_distinct_corners(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

/// Whether all corners exist and are finite.
inline bool has_valid_corners(std::span<const Vec3f> vertices, const Triangle& t) {
  return std::all_of(t.begin(), t.end(),
                     [&](std::uint32_t v) { return v < vertices.size() && is_finite(vertices[v]); });
}

/// Normal of a triangle times twice its area; zero if a corner is nonexistent or not finite.
inline Vec3 doubled_area(std::span<const Vec3f> vertices, const Triangle& t) {
  if (std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return v >= vertices.size(); })) return {};
  const Vec3 a(vertices[t[0]]), area = cross(Vec3(vertices[t[1]]) - a, Vec3(vertices[t[2]]) - a);
  return is_finite(area) ? area : Vec3{};
}

}  // namespace sansmesh::inline v1
