// Neighbouring points in neighbouring slots.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/vec.h"

namespace sansmesh {

/// An order of the points along the Morton curve of their box (of equal codes by number; what is not finite last).
/// Empty where they are few, or where consecutive ones lie close together as they are (lines, images, lattices): then
/// to sort them costs more than it gains.
std::vector<std::uint32_t> locality_order(std::span<const Vec3> points);

}  // namespace sansmesh
