#include "sansmesh/jobs/solid_parts.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/solids.h"

namespace sansmesh::inline v1 {

CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress) {
  CsgMeshOptions own = options;
  if (!own.components) own.components = solid.usual_components();
  CsgResult result;
  result.mesh = mesh_csg(solid.parts().solid, own, progress, &result.report);
  result.notes = solid.open_notes();
  add_notes(result.notes, "mesh", result.report.warnings);
  return result;
}

}  // namespace sansmesh::inline v1
