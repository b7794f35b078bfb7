// Mesh of a solid made of functions, meshes, volumes and primitives.
#pragma once

#include <vector>

#include "sansmesh/jobs/solid_model.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct CsgResult {
  TriangleMesh mesh;
  CsgMeshReport report;
  /// "open": functions whose surface bounds no solid; "mesh": what there is to say of the mesh.
  std::vector<Note> notes;
};

/// By mesh_csg; of solids with functions parts too small to count are left out by default, of others none. Throws
/// ArgumentError for bad options, and for solids without an end; DataError where there is no surface; Cancelled.
CsgResult mesh_of_solid(const SolidModel& solid, const CsgMeshOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
