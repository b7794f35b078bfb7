// What somebody may have meant who mistyped a word.
#pragma once

#include <string>
#include <vector>

namespace sansmesh::cli {

/// Those of the known words that a mistyped one looks like, best first, three at most: a few letters left out, added,
/// exchanged or wrong, or the beginning of a word. Capitals and underscores do not count.
std::vector<std::string> similar_words(const std::string& mistyped, const std::vector<std::string>& known);

/// " (did you mean a or b?)", or nothing.
std::string did_you_mean(const std::string& mistyped, const std::vector<std::string>& known);

/// The same of a message that lists the words there are behind the one that is none of them: "no view 'tpo': front, top
/// or iso". The mistyped one is the last in quotes unless it is given.
std::string did_you_mean_listed(const std::string& message, std::string mistyped = {});

/// The same of a file that does not exist: of those in its folder, or, if that is missing, of a folder like it.
std::string did_you_mean_file(const std::string& missing);

}  // namespace sansmesh::cli
