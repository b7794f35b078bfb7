// Parses names, numbers and lists from short texts, for example option values.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// Lower-case copy (ASCII).
std::string lower_case(std::string_view text);

/// Upper-case copy (ASCII).
std::string upper_case(std::string_view text);

/// Returns the text without leading and trailing blanks: spaces, tabs, carriage returns, form feeds and vertical tabs.
std::string_view without_blanks(std::string_view text);

/// Splits a text at a character; returns one part if the character does not occur.
std::vector<std::string> parts_between(std::string_view text, char between);
inline std::vector<std::string> between_commas(std::string_view text) { return parts_between(text, ','); }

/// Returns whether the whole text is a decimal number in C syntax, and reads it. "inf" is a number, "nan" is not.
bool reads_as_number(std::string_view text, double& value);

/// Parses a finite number, with or without surrounding blanks.
std::optional<double> number_in(std::string_view text);
/// Parses finite numbers separated by commas; returns nothing if a part is not a number.
std::optional<std::vector<double>> numbers_in(std::string_view text);
/// Same, for exactly `count` numbers.
std::optional<std::vector<double>> numbers_in(std::string_view text, std::size_t count);
/// Parses an integer from `least` to `most`; accepts "1e6".
std::optional<long long> whole_in(std::string_view text, long long least, long long most);

}  // namespace sansmesh::inline v1
