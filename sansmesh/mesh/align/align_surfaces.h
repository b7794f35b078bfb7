// Alignment of one surface with another.
#pragma once

#include "sansmesh/local_frame.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Share of `differing` above which two surfaces have different shapes.
constexpr double kOtherShape = 0.1;

/// Finds the motion that aligns samples of `moving` with the surface of `fixed` (its triangles, or the tangent planes
/// of its points). Minimises distances from samples to the surface with Tukey weights whose width follows the median
/// distance, until convergence [chen1992], [rusinkiewicz2019]. Ignores samples beyond borders and samples with another
/// normal, so that a part can be aligned with the whole, and overlapping parts with each other. The global search tries
/// 480 rotations about the centre and pairs of points with similar features [rusu2009], and refines the poses with the
/// largest overlap. Independent of the number of threads. Estimates missing normals. Throws DataError if a surface has
/// fewer than 20 finite points, or no extent.
SurfaceAlignment align_surfaces(const TriangleMesh& moving, const TriangleMesh& fixed,
                                const SurfaceAlignmentOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
