// Options that are numbers in a range.
#pragma once

namespace sansmesh {

/// Throws ArgumentError that names the option, its range and the value unless lowest <= value <= highest.
void check_range(const char* name, double value, double lowest, double highest);

}  // namespace sansmesh
