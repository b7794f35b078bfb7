// Finds known words similar to a mistyped one, for error messages.
#pragma once

#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// Distance between a known word and the typed one: 0 if they differ only in capitals and underscores, −1 if they are
/// not similar.
int word_distance(const std::string& mistyped, const std::string& known);

/// Known words similar to a mistyped one, best first, at most three: a few letters omitted, inserted, swapped or
/// replaced, or a prefix. Ignores capitals and underscores.
std::vector<std::string> similar_words(const std::string& mistyped, const std::vector<std::string>& known);

/// "a, b or c".
std::string joined_by_or(const std::vector<std::string>& words);

/// Returns " (did you mean a or b?)", or an empty text.
std::string did_you_mean(const std::string& mistyped, const std::vector<std::string>& known);

}  // namespace sansmesh::inline v1
