// Fewer points of a cloud, by their numbers alone. (By their distances: poisson_discs.h.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// `count` of the numbers below n, ascending, as if drawn by chance, but always the same ones; all if there are no
/// more.
std::vector<std::uint32_t> scattered_choice(std::size_t n, std::size_t count);

/// 0, step, 2 step, … below n. Throws ArgumentError for a step of 0.
std::vector<std::uint32_t> every_nth(std::size_t n, std::size_t step);

}  // namespace sansmesh::inline v1
