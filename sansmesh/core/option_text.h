// Numbers and lists read from short texts, such as the values of options.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// A text without the blanks at its ends.
std::string_view without_blanks(std::string_view text);

/// The parts of a text between these characters; one part if it has none of them.
std::vector<std::string> parts_between(std::string_view text, char between);
inline std::vector<std::string> between_commas(std::string_view text) { return parts_between(text, ','); }

/// Tells whether the whole text is a number, as C writes decimal ones, and reads it. "inf" is a number, "nan" is none.
bool reads_as_number(std::string_view text, double& value);

/// The finite number that a text is, with or without blanks around it; nothing if it is none.
std::optional<double> number_in(std::string_view text);
/// Finite numbers with commas between them; nothing if a part is no number.
std::optional<std::vector<double>> numbers_in(std::string_view text);
/// The same, if there are exactly `count` of them.
std::optional<std::vector<double>> numbers_in(std::string_view text, std::size_t count);
/// The whole number of least..most that a text is, "1e6" included.
std::optional<long long> whole_in(std::string_view text, long long least, long long most);

}  // namespace sansmesh::inline v1
