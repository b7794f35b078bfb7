// From loose pieces of curves to curves: shared by the sections of meshes and of fields.
#pragma once

#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// A directed piece from one place to another, which are numbered.
struct SectionPiece {
  std::uint32_t from, to;
};

struct SectionChain {
  std::vector<std::uint32_t> places;  ///< in order; the first is not repeated at the end of a closed chain
  bool closed = false;
};

/// Every piece is used once. Where as many pieces begin as end at every place, all chains are closed. Pieces that run
/// against the others (of surfaces not oriented consistently) are turned round. In the order of the lowest piece of
/// each chain, open chains first.
std::vector<SectionChain> chain_pieces(const std::vector<SectionPiece>& pieces, std::size_t places);

}  // namespace sansmesh::inline v1
