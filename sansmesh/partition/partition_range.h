// Bounds of a partition of unity in balls.
#pragma once

#include <span>

#include "sansmesh/partition/partition_state.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Like PartitionOfUnity::ranges, in world coordinates.
void partition_ranges(const PartitionState& partition, std::span<const Vec3> x, double radius,
                      std::span<ValueRange> found);

}  // namespace sansmesh::inline v1
