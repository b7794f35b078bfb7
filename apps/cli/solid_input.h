// A solid from an expression of functions, volumes and primitives.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "console.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/meshing/mesh_options.h"

namespace sansmesh::cli {

struct SolidInput {
  Solid solid;
  std::vector<std::string> files;                                           ///< that the expression names
  std::map<std::string, std::shared_ptr<const SurfaceFunction>> functions;  ///< those of them that are functions

  /// Which parts of its mesh to keep where nobody says: functions of scans may have small sheets far from their
  /// surface.
  ComponentChoice usual_components() const;
  /// Warns of functions whose surface bounds no solid.
  void warn_of_open(Console& console) const;
};

/// Whether so much of a function's surface bounds no solid that a user should know.
bool is_open(const SurfaceFunction& function);

/// Function files, isosurfaces (data.vtu[Temp=300]) and what parse_csg knows. Throws FileError and ArgumentError.
SolidInput open_solid(const std::string& expression, Console& console);

}  // namespace sansmesh::cli
