// Words for the parts of a surface that are kept.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/meshing/mesh_options.h"

namespace sansmesh {

/// "auto", "all", "largest" or a number.
std::string text_of_option(const ComponentChoice& choice);
/// The way back. Throws ArgumentError.
void option_of_text(std::string_view word, ComponentChoice& choice);

}  // namespace sansmesh
