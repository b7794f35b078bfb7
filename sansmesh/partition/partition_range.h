// What a partition of unity lies between in balls; not part of the public interface.
#pragma once

#include <span>

#include "sansmesh/partition/partition_state.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// As PartitionOfUnity::ranges, in world coordinates.
void partition_ranges(const PartitionState& partition, std::span<const Vec3> x, double radius,
                      std::span<ValueRange> found);

}  // namespace sansmesh::inline v1
