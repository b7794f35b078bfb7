// Suggestions for mistyped words.
#pragma once

#include <string>

#include "sansmesh/core/similar_words.h"

namespace sansmesh::cli {

/// " (did you mean a or b?)", or nothing, for a message that lists the valid words after the invalid one: "no view
/// 'tpo': front, top or iso". The invalid word is the last one in quotes unless given.
std::string did_you_mean_listed(const std::string& message, std::string mistyped = {});

/// Suggestion for a missing file: similar names in its folder or, if that is missing, similar folders.
std::string did_you_mean_file(const std::string& missing);

}  // namespace sansmesh::cli
