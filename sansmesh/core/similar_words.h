// Known words that a mistyped one looks like, for errors that help.
#pragma once

#include <string>
#include <vector>

namespace sansmesh::inline v1 {

/// How far a known word is from what was typed: 0 if they differ in capitals and underscores alone; −1 if nobody would
/// take one for the other.
int unlikeness(const std::string& mistyped, const std::string& known);

/// Those of the known words that a mistyped one looks like, best first, three at most: a few letters left out, added,
/// exchanged or wrong, or the beginning of a word. Capitals and underscores do not count.
std::vector<std::string> similar_words(const std::string& mistyped, const std::vector<std::string>& known);

/// "a, b or c".
std::string joined_by_or(const std::vector<std::string>& words);

/// " (did you mean a or b?)", or nothing.
std::string did_you_mean(const std::string& mistyped, const std::vector<std::string>& known);

}  // namespace sansmesh::inline v1
