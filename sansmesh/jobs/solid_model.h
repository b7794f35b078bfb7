// A solid from an expression of functions, meshes, volumes and primitives, with all that it needs.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct SolidModel {
  std::string expression;
  Solid solid;
  std::vector<std::string> files;                                           ///< that the expression names
  std::map<std::string, std::shared_ptr<const SurfaceFunction>> functions;  ///< those of them that are functions
  std::vector<Note> notes;  ///< "read", "volume", "reconstruction": of files; "mesh_solid": what was done to a mesh

  /// Which parts of its mesh to keep where nobody says: functions of scans may have small sheets far from their
  /// surface.
  ComponentChoice usual_components() const;
  /// The function that is all of it; null of other solids.
  std::shared_ptr<const SurfaceFunction> whole_function() const;
  /// "open": functions whose surface bounds no solid.
  std::vector<Note> open_notes() const;

  static const ReportSchema& schema();
};

/// Whether so much of a function's surface bounds no solid that a user should know.
bool is_open(const SurfaceFunction& function);

/// Function files, isosurfaces (data.vtu[Temp=300]) and what parse_csg knows. Throws FileError, ArgumentError,
/// DataError that begins with the name of a volume.
SolidModel read_solid(const std::string& expression, Progress& progress);

}  // namespace sansmesh::inline v1
