// Numbers read from short texts, such as the values of options.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace sansmesh {

/// A text without the blanks at its ends.
std::string_view without_blanks(std::string_view text);

/// Whether all of a text is a number, in any notation that C has but hexadecimal ones; infinite ones are numbers, "nan"
/// is none.
bool reads_as_number(std::string_view text, double& value);

/// The finite number that a text is, with or without blanks around it; nothing if it is none.
std::optional<double> number_in(std::string_view text);
/// Such numbers with commas between them.
std::optional<std::vector<double>> numbers_in(std::string_view text);
/// So many of them; nothing if there are more or fewer.
std::optional<std::vector<double>> numbers_in(std::string_view text, std::size_t count);
/// The whole number of least..most that a text is, "1e6" included.
std::optional<long long> whole_in(std::string_view text, long long least, long long most);

}  // namespace sansmesh
