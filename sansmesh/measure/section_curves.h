// What the sections of meshes and of fields share.
#pragma once

#include <array>
#include <vector>

#include "sansmesh/measure/section.h"
#include "sansmesh/measure/section_chain.h"

namespace sansmesh::inline v1 {

/// The curves along the chains through `points` (coordinates in the plane), and their measures. Neighbouring points at
/// the same place become one; closed curves without area that shrink to fewer than three points are dropped, open ones
/// to fewer than two.
Section make_section(const CutPlane& plane, const std::vector<SectionChain>& chains,
                     const std::vector<std::array<double, 2>>& points);

}  // namespace sansmesh::inline v1
