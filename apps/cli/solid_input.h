// A solid from an expression of functions, volumes and primitives.
#pragma once

#include <string>

#include "console.h"
#include "sansmesh/jobs/solid_model.h"

namespace sansmesh::cli {

/// What read_solid reads; its notes go to the console. Throws FileError and ArgumentError.
SolidModel open_solid(const std::string& expression, Console& console);

}  // namespace sansmesh::cli
