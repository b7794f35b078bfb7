// One surface moved onto another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/local_frame.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// From this share of `differing` on two surfaces are not of the same shape.
constexpr double kOtherShape = 0.1;

/// Finds the motion that brings samples of `moving` onto the surface of `fixed` (its triangles, or the tangent planes
/// of its points): distances from sample to surface, weighted down by Tukey's function of a width that follows the
/// median, until they do not fall any more [chen1992], [rusinkiewicz2019]. Samples beyond borders and such with another
/// normal do not count, so that a part fits onto the whole, and two parts that overlap onto each other. From anywhere:
/// 480 rotations about the middle, and pairs of places with like features [rusu2009]; the poses in which most of both
/// surfaces lie on each other are searched from. The same for any number of threads. Points without normals get
/// estimated ones. Throws DataError where a side has fewer than 20 finite points, or no extent.
SurfaceAlignment align_surfaces(const TriangleMesh& moving, const TriangleMesh& fixed,
                                const SurfaceAlignmentOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
