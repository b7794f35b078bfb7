// Lines of files as polylines about an origin.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/polyline_set.h"

namespace sansmesh::inline v1::io {

/// Stores positions (world, double) about their medians: single positions far away (a title block) cost no digits.
inline void place_lines(PolylineSet& lines, std::span<const Vec3> positions) {
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> along;
    for (const Vec3& p : positions)
      if (is_finite(p)) along.push_back(p[k]);
    if (along.empty()) break;
    lines.origin[k] = static_cast<double>(static_cast<float>(median(along)));
  }
  lines.positions.clear();
  lines.positions.reserve(positions.size());
  for (const Vec3& p : positions) lines.positions.push_back(Vec3f(p - lines.origin));
}

}  // namespace sansmesh::inline v1::io
