// Intersections of rays with iso-surfaces.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/render/volume/traced_walk.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1::detail {

/// Replaces `roots` by the crossings of iso-surfaces in the steps of a round, sorted by walk and distance. Returns the
/// number of field evaluations.
std::size_t find_iso_roots(const VolumeField& field, const TracedFrame& frame, std::span<const IsoSurface> isos,
                           const TracedRound& round, std::vector<IsoRoot>& roots);

}  // namespace sansmesh::inline v1::detail
