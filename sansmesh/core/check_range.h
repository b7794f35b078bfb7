// Range checks for options.
#pragma once

namespace sansmesh::inline v1 {

/// Throws ArgumentError that names the option, its range and the value unless lowest <= value <= highest.
void check_range(const char* name, double value, double lowest, double highest);

/// Throws ArgumentError with this message unless `ok`.
void check_argument(bool ok, const char* message);

}  // namespace sansmesh::inline v1
