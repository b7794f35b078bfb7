// Times of files that are the steps of a volume.
#pragma once

#include <cstddef>
#include <vector>

namespace sansmesh::inline v1 {

/// Times of the files: `given` holds all of them, or the first and the interval; default 0, 1, 2, …. Throws
/// ArgumentError for other counts.
std::vector<double> times_of_series(const std::vector<double>& given, std::size_t files);

}  // namespace sansmesh::inline v1
