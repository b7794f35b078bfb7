// Lines of files as polylines about an origin.
#pragma once

#include <span>

#include "sansmesh/box.h"
#include "sansmesh/polyline_set.h"

namespace sansmesh::inline v1::io {

/// Stores positions (world, double) about the centre of their box.
inline void place_lines(PolylineSet& lines, std::span<const Vec3> positions) {
  Box3 box;
  for (const Vec3& p : positions)
    if (is_finite(p)) box.extend(p);
  if (!box.empty()) lines.origin = Vec3(Vec3f(box.center()));
  lines.positions.clear();
  lines.positions.reserve(positions.size());
  for (const Vec3& p : positions) lines.positions.push_back(Vec3f(p - lines.origin));
}

}  // namespace sansmesh::inline v1::io
