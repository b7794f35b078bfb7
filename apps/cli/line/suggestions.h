// What somebody may have meant who mistyped a word.
#pragma once

#include <string>

#include "sansmesh/core/similar_words.h"

namespace sansmesh::cli {

/// " (did you mean a or b?)", or nothing, of a message that lists the words there are behind the one that is none of
/// them: "no view 'tpo': front, top or iso". The mistyped one is the last in quotes unless it is given.
std::string did_you_mean_listed(const std::string& message, std::string mistyped = {});

/// The same of a file that does not exist: of those in its folder, or, if that is missing, of a folder like it.
std::string did_you_mean_file(const std::string& missing);

}  // namespace sansmesh::cli
