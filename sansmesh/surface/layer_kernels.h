// One application of the projection of METHODS §5.1 to a group of points: sixteen at a time, SIMD inside.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

struct LayerKernel {
  bool predictor = true;     ///< plane and polynomial of all samples around, whatever their distance
  bool corrector = true;     ///< the same about the place found, by distance
  bool alternating = false;  ///< predictor: direction and offset in turns, not at once
  bool line_search = false;  ///< corrector: the offset by minimisation along the normal
  bool sheets = true;        ///< samples that face away from those next to the point are ignored
};

/// Only lanes with inside > 0 hold a foot point.
void project_onto_layer(const LayerKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                        GroupFeet& out);

}  // namespace sansmesh::inline v1::detail
