// Which of several steps in time is wanted.
#pragma once

#include <cstddef>
#include <string>

namespace sansmesh::inline v1::io {

/// Throws ArgumentError naming `time_step` and the file where there are not that many steps; a file without times has
/// one.
void check_time_step(const std::string& file, std::size_t wanted, std::size_t steps);

}  // namespace sansmesh::inline v1::io
