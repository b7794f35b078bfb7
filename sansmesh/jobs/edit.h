// Edits of a function, and its mesh brought up to date.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct EditInput {
  SurfaceFunction function;
  std::string name = "the function";  ///< in messages
  /// The function's mesh before the edits, by mesh_function without options: only what they change is made anew.
  std::optional<TriangleMesh> mesh = {};
  std::string mesh_name = "the mesh";
};

struct EditedFunction {
  SurfaceFunction function;
  std::vector<EditReport> steps;
  // If a mesh is asked for.
  TriangleMesh mesh = {};
  MeshUpdate update = {};  ///< what of it is new; of one that was made without another nothing is told

  static const ReportSchema& schema();
};

/// `make_mesh`: of the function as the edits leave it. Throws ArgumentError that begins with the step, "step 2: ", for
/// edits with values out of range; DataError that begins with a name where an edit cannot be done, nothing is left to
/// be meshed, or the mesh is not one of the function; Cancelled.
EditedFunction edit(EditInput input, const std::vector<Edit>& edits, bool make_mesh, Progress& progress);

/// An edit and its place, in words.
std::string words_of(const EditReport& step);
/// What of a mesh of so many triangles is new: ", of which 162 are new; 98.8 % kept", or why all of it is.
std::string words_of(const MeshUpdate& update, std::size_t triangles);

}  // namespace sansmesh::inline v1
