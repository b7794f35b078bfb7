// Times of the steps of a series.
#pragma once

#include <cstddef>
#include <span>

namespace sansmesh::inline v1 {

/// Throws ArgumentError that names the step unless all times are finite and increase.
void check_step_times(std::span<const double> times);

/// Index of the step at or before t, except the last. There are at least two times.
std::size_t step_interval(std::span<const double> times, double t);

}  // namespace sansmesh::inline v1
