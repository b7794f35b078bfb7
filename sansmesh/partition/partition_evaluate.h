// Values and gradients of a partition of unity.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/partition/partition_state.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Like ScalarField::evaluate, in world coordinates; with `sized`, like SignField::evaluate_signs.
void evaluate_partition(const PartitionState& partition, std::span<const Vec3> x, std::span<double> values,
                        std::span<Vec3> gradients, std::span<std::uint8_t> sized = {});

}  // namespace sansmesh::inline v1
