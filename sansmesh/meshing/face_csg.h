// Meshes of solids by exact operations on their faces.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/csg/solid.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Which algorithm meshes a solid, and why. Throws ArgumentError if `options` require faces and a part has none.
struct CsgMesherChoice {
  bool faces = false;
  std::string reason;
};
CsgMesherChoice choose_csg_mesher(const Solid& solid, const CsgMeshOptions& options);

/// Boundary of a solid whose parts have faces (face_builder.h), by combine_solids. Vertices are rounded to float in the
/// end. Nothing if the edges of a mesh do not enclose a solid; `report->reason` names it. Throws like mesh_csg.
std::optional<TriangleMesh> mesh_of_faces(const Solid& solid, const CsgMeshOptions& options, Progress& progress,
                                          CsgMeshReport& report);

}  // namespace sansmesh::inline v1
