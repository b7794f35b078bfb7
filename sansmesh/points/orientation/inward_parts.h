// Closed parts of a cloud whose given normals point inward.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Flips consistent normals of closed parts that point inward, and returns their number. A part inside of others faces
/// inward on a cavity: it keeps its side relative to the outermost part around it, unless a surface around it already
/// faces inward. `mostly`: most of the samples are known to face inward; then weaker evidence suffices, and parts that
/// are not closed follow if all closed ones are flipped. Otherwise the winding number must confirm that a part is
/// closed. `noise`: length.
std::size_t flip_inward_parts(PointSet& points, double noise, bool mostly, Progress& progress);

}  // namespace sansmesh::inline v1
