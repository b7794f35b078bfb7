// Selects points of a cloud by index. (By distance: poisson_discs.h.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// `count` pseudo-random numbers below n, ascending and reproducible; all if `count` >= n.
std::vector<std::uint32_t> scattered_choice(std::size_t n, std::size_t count);

/// `count` evenly spaced numbers below n; all if `count` >= n.
std::vector<std::uint32_t> evenly_spaced(std::size_t n, std::size_t count);

/// 0, step, 2 step, … below n. Throws ArgumentError if `step` is 0.
std::vector<std::uint32_t> every_nth(std::size_t n, std::size_t step);

}  // namespace sansmesh::inline v1
