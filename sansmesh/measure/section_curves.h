// Builds a section from chains of points, for meshes and fields.
#pragma once

#include <array>
#include <vector>

#include "sansmesh/measure/section.h"
#include "sansmesh/measure/section_chain.h"

namespace sansmesh::inline v1 {

/// The curves along the chains through `points` (plane coordinates), with their measures. Consecutive coincident points
/// become one; curves reduced below three points (closed) or two points (open) are dropped.
Section make_section(const CutPlane& plane, const std::vector<SectionChain>& chains,
                     const std::vector<std::array<double, 2>>& points);

}  // namespace sansmesh::inline v1
