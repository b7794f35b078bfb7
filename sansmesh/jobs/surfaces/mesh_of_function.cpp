#include "sansmesh/function/mesh_function.h"
#include "sansmesh/functions.h"

namespace sansmesh::inline v1 {

MeshFunctionResult mesh_of_function(const SurfaceFunction& function, const MeshOptions& options, Progress& progress) {
  MeshFunctionResult result;
  result.mesh = mesh_function(function.fitted(), options, progress, &result.report);
  add_notes(result.notes, result.report.notes);
  return result;
}

}  // namespace sansmesh::inline v1
