// Chains the pieces of a section into curves, for meshes and fields.
#pragma once

#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// A directed piece between two numbered points.
struct SectionPiece {
  std::uint32_t from, to;
};

struct SectionChain {
  std::vector<std::uint32_t> points;  ///< in order; the first is not repeated at the end of a closed chain
  bool closed = false;
};

/// Uses every piece once. If equally many pieces begin and end at every point, all chains are closed. Pieces opposed to
/// the others (on inconsistently oriented surfaces) are reversed. Ordered by the lowest piece of each chain, open
/// chains first.
std::vector<SectionChain> chain_pieces(const std::vector<SectionPiece>& pieces, std::size_t points);

}  // namespace sansmesh::inline v1
