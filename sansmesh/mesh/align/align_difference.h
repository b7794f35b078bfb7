// Difference in shape between two aligned surfaces, told apart from the noise of their samples.
#pragma once

#include "sansmesh/mesh/align/align_side.h"

namespace sansmesh::inline v1::detail {

struct ShapeDifference {
  double share = 0;   ///< of the samples that lie beside the surface: those where its shape is another one, 0..1
  double offset = 0;  ///< median distance there
};

/// Noise differs from sample to sample, shape does not: the median of the offsets of the samples within `spacing` of
/// each is compared with what their scatter explains, and with `least` (length), which is never a difference. Samples
/// beyond borders, without a surface within `reach`, or with another normal do not count.
ShapeDifference shape_difference(const OrientedPoints& moving, const WholeSurface& fixed, const Pose& pose,
                                 double spacing, double reach, double least, bool signs);

}  // namespace sansmesh::inline v1::detail
