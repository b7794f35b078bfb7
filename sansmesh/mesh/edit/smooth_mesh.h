// Noise taken off a mesh, its volume kept.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/repair_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Taubin's filter [taubin1995]: steps to the mean of the neighbours (weights: cotangents, clamped to be positive) and
/// a little farther back, in turn, which take off what is shorter than some edges and let longer waves pass, so that
/// the mesh does not shrink; if it is closed, vertices then move along the normals, those of a component all by the
/// same distance, until each component has its volume again. With `creases` bilateral means of the normals of triangles
/// [zheng2011], to which vertices are fitted [sun2007]. Vertices at the same place stay together. Normals of vertices
/// are made anew if there were any. The same for any number of threads.
SmoothReport smooth_mesh(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
