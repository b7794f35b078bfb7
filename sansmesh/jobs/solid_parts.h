// Parts of a solid that was read from an expression.
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
  std::vector<std::string> files = {};                    ///< that the expression names
  std::map<std::string, SurfaceFunction> functions = {};  ///< those of them that are functions
  std::vector<Note> notes = {};

  /// The function that is all of it; null of other solids.
  const SurfaceFunction* whole_function() const;
};

/// Whether so much of a function's surface bounds no solid that a user should know.
bool is_open(const SurfaceFunction& function);

}  // namespace sansmesh::inline v1
