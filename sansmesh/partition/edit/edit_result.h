// Arguments and results of edits of a partition of unity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Indices of supports, ascending.
using Selection = std::vector<std::uint32_t>;

/// Samples of a function in the order of the Morton curve of its root cube, relative to its origin.
struct EditSamples {
  std::span<const Vec3f> positions, normals;
};

struct EditResult {
  PartitionData data;
  Box3f changed;  ///< bounds the region where the function may have changed (except for its far field)
  /// Finer bounds: at most 64 boxes whose union contains that region; they may overlap.
  std::vector<Box3f> regions;
  std::size_t changes = 0;   ///< chosen supports that changed
  std::size_t supports = 0;  ///< supports that replaced the chosen ones
  std::size_t lower = 0;     ///< changed supports of a lower degree than requested
};

}  // namespace sansmesh::inline v1
