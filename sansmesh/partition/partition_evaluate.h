// Values and gradients of a partition of unity; not part of the public interface.
#pragma once

#include <span>

#include "sansmesh/core/vec.h"
#include "sansmesh/partition/partition_state.h"

namespace sansmesh {

/// As ScalarField::evaluate, in world coordinates.
void evaluate_partition(const PartitionState& partition, std::span<const Vec3> x, std::span<double> values,
                        std::span<Vec3> gradients);

}  // namespace sansmesh
