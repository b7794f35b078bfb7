// Moments of files that are the steps of a volume.
#pragma once

#include <cstddef>
#include <vector>

namespace sansmesh::inline v1 {

/// When so many files are: `given` of each, or the first and the step; 0, 1, 2, … if nothing was given. Throws
/// ArgumentError for other numbers of times.
std::vector<double> times_of_series(const std::vector<double>& given, std::size_t files);

}  // namespace sansmesh::inline v1
