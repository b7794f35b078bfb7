// A solid from an expression of functions, volumes and primitives.
#pragma once

#include <string>

#include "console.h"
#include "sansmesh/solids.h"

namespace sansmesh::cli {

/// Reads a solid (read_solid) and prints its notes. Throws FileError and ArgumentError.
SolidModel open_solid(const std::string& expression, Console& console);

}  // namespace sansmesh::cli
