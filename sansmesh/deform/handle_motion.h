// Handles on their way: poses between before and after the deformation.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/deform_options.h"

namespace sansmesh::inline v1 {

/// The handles as far as they are at a share of the way, 0..1 (other shares go on). Those of one group move as one body
/// on a screw, the rotation and translation that fits their way best, and what is left of each handle's way grows
/// straight with the share; handles of no group, and groups that do not turn, move on straight lines. Directions turn
/// with their group, or by the shortest way. At 0 all are where they were before, at 1 where they are after.
std::vector<Handle> handles_at(std::span<const Handle> handles, double share);

}  // namespace sansmesh::inline v1
