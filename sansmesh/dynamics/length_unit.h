// Units of length by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sansmesh::inline v1 {

constexpr double kLeastUnit = 1e-9, kMostUnit = 1e9;  ///< m
/// Metres of "mm", "cm", "dm", "m", "km", "inch", "foot".
std::optional<double> metres_of(std::string_view unit);

/// A unit as an option: by its name, or its length in metres.
struct LengthUnit {
  double metres = 1;  ///< kLeastUnit..kMostUnit
};
std::string text_of_option(const LengthUnit& unit);
/// Throws ArgumentError whose fault has the word and what is allowed.
void option_of_text(std::string_view word, LengthUnit& unit);

}  // namespace sansmesh::inline v1
