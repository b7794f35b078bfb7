// Words of the command line as numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/line/option_entry.h"
#include "sansmesh/core/option_text.h"

namespace sansmesh::cli {

/// "'deep'", made printable.
std::string in_quotes(const std::string& word);
/// "must be three numbers with commas between them, not 'a,b'"
ValueError must_be(const std::string& form, const std::string& text);

/// The number that a word is; infinite ones are numbers, those that are none ("nan") are not. Throws ValueError.
double parse_real(const std::string& word);
/// The whole number that a word is, "1e6" included. Throws ValueError, also where it lies outside of least..most.
long long parse_whole(const std::string& word, long long least, long long most);
/// Whether a word is a number, or several with commas between them.
bool are_numbers(const std::string& word);
/// What to type in place of a word that is no number, "1,000" or "5mm": ": write 1000" or nothing.
std::string number_wanted(const OptionEntry& option, const std::string& word);
/// Throws ValueError unless the value is one that the option takes, as far as its entry tells.
void check_value(const OptionEntry& option, const std::string& value);

}  // namespace sansmesh::cli
