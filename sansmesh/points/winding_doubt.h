// A look at the signs of normals that knows nothing of neighbours: do they enclose what their samples lie around?
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/points/relation_graph.h"

namespace sansmesh::inline v1::detail {

/// Share of the samples at which the winding number of their own part, with the signs that the normals have, is not the
/// half that it is all over a closed surface, but less than half or more than one and a half times that, on the mean
/// over the places nearby. `part` of each sample; of parts that are `open`, and of small ones, nothing is asked. Noise
/// (length) and spacings are smoothed away. Signs that are wrong in whole regions show in all that these face; so does
/// noise that is as large as the shape is thin, where nobody can tell the sides. At fixed places, the same for any
/// number of threads.
double winding_doubt(const RelationGraph& graph, std::span<const std::uint32_t> part,
                     std::span<const std::uint8_t> open, double noise);

}  // namespace sansmesh::inline v1::detail
