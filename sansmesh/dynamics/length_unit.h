// Named units of length.
#pragma once

#include <optional>
#include <string_view>

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

constexpr double kLeastUnit = 1e-9, kMostUnit = 1e9;  ///< m
/// Metres of "mm", "cm", "dm", "m", "km", "inch", "foot".
std::optional<double> metres_of(std::string_view unit);

}  // namespace sansmesh::inline v1
