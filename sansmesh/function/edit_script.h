// Edit scripts: edits of functions as text.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/function/edit_function.h"

namespace sansmesh::inline v1 {

/// Edits of a script: JSON as described in docs/formats/edit-script.md. Throws ArgumentError that names the step and
/// the field.
std::vector<Edit> parse_edit_script(const std::string& json);
/// The script of some edits; parse_edit_script reads it back.
std::string edit_script(const std::vector<Edit>& edits);

}  // namespace sansmesh::inline v1
