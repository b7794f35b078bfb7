// Identifies coincident vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Index of the first equal position for each position (−0 equals 0; non-finite positions equal only themselves).
std::vector<std::uint32_t> first_at_place(std::span<const Vec3f> positions);

}  // namespace sansmesh::inline v1
