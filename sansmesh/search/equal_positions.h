// Finds equal positions among points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Hash of a position: equal positions have equal hashes (−0 equals 0).
std::uint64_t position_hash(const Vec3f& p);

/// Index of the first equal position for each position (−0 equals 0). Non-finite positions equal only themselves.
std::vector<std::uint32_t> first_equal_positions(std::span<const Vec3f> positions);

}  // namespace sansmesh::inline v1
