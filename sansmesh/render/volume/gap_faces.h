// Faces of gaps along rays through a volume.
#pragma once

#include <cstddef>

#include "sansmesh/render/volume/traced_walk.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1::detail {

/// Whether a gap, or the part between two gaps, may begin and end within a step, given the slopes at its ends.
bool may_pass_face(const TracedFrame& frame, const TracedSample& before, const TracedSample& now);

/// Where steps of a round enter or leave a gap, requests a sample beside the face. Returns the number of evaluations.
std::size_t find_gap_faces(const ScalarField& gap, const TracedFrame& frame, const TracedRound& round);

}  // namespace sansmesh::inline v1::detail
