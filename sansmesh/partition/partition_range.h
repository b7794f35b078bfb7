// What a partition of unity lies between in balls; not part of the public interface.
#pragma once

#include <span>

#include "sansmesh/core/vec.h"
#include "sansmesh/field/scalar_field.h"
#include "sansmesh/partition/partition_state.h"

namespace sansmesh {

/// As PartitionOfUnity::ranges, in world coordinates.
void partition_ranges(const PartitionState& partition, std::span<const Vec3> x, double radius,
                      std::span<ValueRange> found);

}  // namespace sansmesh
