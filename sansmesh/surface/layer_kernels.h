// Kernel of the layer projection (tejada2008, 5.2), one step for groups of sixteen points.
#pragma once

#include <span>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {

struct LayerKernel {
  bool predictor = true;     ///< plane and polynomial of all samples around, regardless of distance
  bool corrector = true;     ///< the same about the predicted point, weighted by distance
  bool alternating = false;  ///< predictor: direction and offset alternately instead of jointly
  bool line_search = false;  ///< corrector: the offset by minimisation along the normal
  bool sheets = true;        ///< samples that face away from those next to the point are ignored
};

/// Only lanes with inside > 0 hold a foot point.
void project_onto_layer(const LayerKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                        GroupFeet& out);

}  // namespace sansmesh::inline v1::detail
