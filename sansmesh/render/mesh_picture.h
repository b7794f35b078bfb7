// Pictures of meshes and point clouds without a display: ray cast, softly lit, the same on every run.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The mesh seen in perspective, framed to fill the picture. Meshes without triangles are clouds: discs where there are
/// normals, else balls. Vertices that are not finite are left out. The picture does not depend on the number of
/// threads. Throws DataError where there is nothing to see, ArgumentError for bad options.
Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress);
Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options = {});

}  // namespace sansmesh::inline v1
