// Lines of points: what particles leave behind.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Lines in space. Line i has the points offsets[i], …, offsets[i + 1] − 1 (at least one).
struct PolylineSet {
  Vec3 origin;                          ///< of the coordinates: where a point lies is origin + position
  std::vector<Vec3f> positions;         ///< of the points, relative to `origin`, line after line
  std::vector<std::size_t> offsets{0};  ///< where in `positions` a line begins; one more entry than lines
  AttributeTable attributes;            ///< a row for each point
  AttributeTable line_attributes;       ///< a row for each line
  /// Number of lines.
  std::size_t size() const { return offsets.size() - 1; }
};

}  // namespace sansmesh::inline v1
