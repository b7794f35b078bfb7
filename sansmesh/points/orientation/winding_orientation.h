// Signs of doubtful parts by consistent winding numbers.
#pragma once

#include "sansmesh/points/orientation/relation_graph.h"
#include "sansmesh/points/orientation/sign_parts.h"

namespace sansmesh::inline v1::detail {

/// Weighted agreement of neighbours above which signs are free of contradictions.
inline constexpr double kNoContradiction = 0.9995;

/// Replaces the signs of parts by signs with consistent winding numbers where these contradict themselves less. Small
/// patches, their neighbours' votes, and the directions of the winding numbers decide together.
void settle_by_winding(const RelationGraph& graph, Parts& parts);

}  // namespace sansmesh::inline v1::detail
