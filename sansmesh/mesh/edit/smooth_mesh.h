// Volume-preserving removal of noise from a mesh.
#pragma once

#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/repair_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Taubin's filter [taubin1995]: alternates steps to the mean of the neighbours (weights: clamped positive cotangents)
/// and slightly larger steps back. This removes waves of a few edges and keeps longer ones, so that the mesh does not
/// shrink. In closed meshes, the vertices of each component are then moved by the same distance along the normals until
/// its volume is restored. With `creases`: bilateral means of triangle normals [zheng2011], to which the vertices are
/// fitted [sun2007]. Coincident vertices stay together. Recomputes vertex normals if there are any. Independent of the
/// number of threads.
SmoothReport smooth_mesh(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
