// Range check of time steps.
#pragma once

#include <cstddef>
#include <string>

namespace sansmesh::inline v1::io {

/// Throws ArgumentError naming `time_step` and the file if the step does not exist; a file without times has one step.
void check_time_step(const std::string& file, std::size_t wanted, std::size_t steps);

}  // namespace sansmesh::inline v1::io
