// Conversion of command line words to numbers.
#pragma once

#include <string>

#include "cli/line/option_entry.h"
#include "sansmesh/core/option_text.h"

namespace sansmesh::cli {

/// "'deep'", with unprintable characters escaped.
std::string in_quotes(const std::string& word);
/// "must be three numbers with commas between them, not 'a,b'"
ValueError must_be(const std::string& form, const std::string& text);

/// Parses a number, which may be infinite but not "nan". Throws ValueError.
double parse_real(const std::string& word);
/// Parses a whole number, also "1e6". Throws ValueError, also outside least..most.
long long parse_whole(const std::string& word, long long least, long long most);
/// True for a number and for a comma-separated list of numbers.
bool are_numbers(const std::string& word);
/// Suggestion for a word that is no number, "1,000" or "5mm": ": write 1000"; empty without one.
std::string number_hint(const OptionEntry& option, const std::string& word);
/// Throws ValueError unless the option's entry allows the value.
void check_value(const OptionEntry& option, const std::string& value);

}  // namespace sansmesh::cli
