// Mesh of a solid made of functions, meshes, volumes and primitives.
#pragma once

#include <vector>

#include "sansmesh/core/note.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/jobs/solid_model.h"
#include "sansmesh/meshing/mesh_csg.h"

namespace sansmesh {

struct CsgResult {
  TriangleMesh mesh;
  CsgMeshReport report;
  /// "open": functions whose surface bounds no solid; "mesh": what there is to say of the mesh.
  std::vector<Note> notes;
};

/// By mesh_csg; of solids with functions parts too small to count are left out by default, of others none. Throws
/// ArgumentError for bad options, and for solids without an end; DataError where there is no surface; Cancelled.
CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress);

}  // namespace sansmesh
