// Polylines, for example trajectories of particles.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct ReferenceSystem;

/// Set of polylines. Line i has the points offsets[i], …, offsets[i + 1] − 1 (at least one).
struct PolylineSet {
  Vec3 origin;                          ///< world position = origin + position
  std::vector<Vec3f> positions;         ///< points relative to `origin`, line by line
  std::vector<std::size_t> offsets{0};  ///< start of each line in `positions`; one more entry than lines
  AttributeTable attributes;            ///< a row per point
  AttributeTable line_attributes;       ///< a row per line
  /// Reference system of the coordinates; null if unknown.
  std::shared_ptr<const ReferenceSystem> reference = {};
  /// Number of lines.
  std::size_t size() const { return offsets.size() - 1; }
};

}  // namespace sansmesh::inline v1
