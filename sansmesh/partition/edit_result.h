// What edits of a partition of unity take and give.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Supports by their number, ascending.
using Selection = std::vector<std::uint32_t>;

/// The samples of a function, along the Morton curve of its root cube, relative to its origin.
struct EditSamples {
  std::span<const Vec3f> positions, normals;
};

struct EditResult {
  PartitionData data;
  Box3f changed;  ///< holds all places where the function may have changed (but for its far field)
  /// The same more closely: boxes, 64 at most, whose union holds them; they may overlap.
  std::vector<Box3f> regions;
  std::size_t changes = 0;   ///< of the chosen supports, those that are not as before
  std::size_t supports = 0;  ///< that took the place of those chosen
  std::size_t lower = 0;     ///< of the changed ones, supports of a lower degree than was asked for
};

}  // namespace sansmesh::inline v1
