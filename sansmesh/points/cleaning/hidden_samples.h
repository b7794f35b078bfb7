// Samples that a smooth sheet above hides from a sensor in the air.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/points/orientation/relation_graph.h"

namespace sansmesh::inline v1::detail {

/// Whether another sheet is above each sample of the graph: it has not been seen from above, and may face down. Only
/// samples with related normals (`firm`) that are not upright hide others or are hidden; leaves and stray samples are
/// neither. Samples of the same sheet uphill hide nothing.
std::vector<std::uint8_t> find_hidden_from_above(const RelationGraph& graph);

}  // namespace sansmesh::inline v1::detail
