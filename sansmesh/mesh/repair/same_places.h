// Vertices at the same place as one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Of each position the index of the first equal one (−0 equals 0; what is not finite equals nothing else).
std::vector<std::uint32_t> first_at_place(std::span<const Vec3f> positions);

}  // namespace sansmesh::inline v1
