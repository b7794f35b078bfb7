// Global check of normal signs by winding numbers, independent of neighbour relations.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/points/orientation/relation_graph.h"

namespace sansmesh::inline v1::detail {

/// Share of the samples whose winding number in their own part deviates from the value ½ on a closed surface: in the
/// mean over nearby samples it is less than half or more than one and a half times that. `part` of each sample; skips
/// `open` and small parts. Smooths over the noise (length) and the spacings. Wrong signs of whole regions affect all
/// samples that these face; so does noise of the size of the shape's thickness, where the sides are not
/// distinguishable. Evaluated at fixed samples, independent of the number of threads.
double winding_doubt(const RelationGraph& graph, std::span<const std::uint32_t> part,
                     std::span<const std::uint8_t> open, double noise);

}  // namespace sansmesh::inline v1::detail
