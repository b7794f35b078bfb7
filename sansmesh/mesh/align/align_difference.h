// Shape difference of two aligned surfaces, separated from the noise of their samples.
#pragma once

#include "sansmesh/mesh/align/align_side.h"

namespace sansmesh::inline v1::detail {

struct ShapeDifference {
  double share = 0;   ///< share (0..1) of the samples near the surface where its shape differs
  double offset = 0;  ///< median distance of these samples
};

/// Noise varies between neighbouring samples, shape does not: compares the median offset of the samples within
/// `spacing` of each sample with the value expected from their scatter, and with `least` (length), below which there is
/// no difference. Ignores samples beyond borders, farther than `reach` from the surface, or with another normal.
ShapeDifference shape_difference(const OrientedPoints& moving, const WholeSurface& fixed, const Similarity& pose,
                                 double spacing, double reach, double least, bool signs);

}  // namespace sansmesh::inline v1::detail
