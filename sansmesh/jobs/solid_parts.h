// Parts of a solid read from an expression.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/note.h"
#include "sansmesh/surface_function.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SolidParts {
  std::string expression;
  Solid solid;
  std::vector<std::string> files = {};                    ///< files in the expression
  std::map<std::string, SurfaceFunction> functions = {};  ///< the functions among them
  std::vector<Note> notes = {};

  /// The function, if the solid consists of it alone; otherwise null.
  const SurfaceFunction* whole_function() const;
};

/// Whether enough of a function's surface bounds no solid to warrant a warning.
bool is_open(const SurfaceFunction& function);

}  // namespace sansmesh::inline v1
