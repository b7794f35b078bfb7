// Meshes and point samples of volume surfaces.
#pragma once

#include <optional>

#include "sansmesh/dataset/volume_surface.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A mesh in input coordinates, closed where the surface is; vertex normals point to smaller values. The sample options
/// of `meshing` (trim, colours, confidence) have no effect; automatic `components` removes parts smaller than the width
/// of the weights, with a warning. Throws DataError if the surface is empty.
TriangleMesh mesh_volume_surface(const VolumeSurface& surface, const MeshOptions& meshing, Progress& progress,
                                 MeshReport* report = nullptr);

/// Evenly spread points with normals in input coordinates, for splats. `distance` between points: a length, at least an
/// eighth of the spacing; default: the spacing. Throws ArgumentError for other distances.
PointSet sample_volume_surface(const VolumeSurface& surface, std::optional<double> distance, Progress& progress);

}  // namespace sansmesh::inline v1
