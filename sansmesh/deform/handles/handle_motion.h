// Interpolation of handles between the poses before and after a deformation.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/deform_options.h"

namespace sansmesh::inline v1 {

/// The handles at a fraction of the motion, 0..1 (other values extrapolate). Handles of one group move as a rigid body
/// on a screw motion, the rotation and translation that fit their displacements best; the remaining displacement of
/// each handle grows linearly. Handles without a group, and groups that do not rotate, move on straight lines.
/// Directions rotate with their group, or by the smallest rotation. 0 gives the positions before, 1 those after.
std::vector<Handle> handles_at(std::span<const Handle> handles, double share);

}  // namespace sansmesh::inline v1
