#include "sansmesh/measure/section_chain.h"

#include <algorithm>
#include <cstddef>

#include "sansmesh/data/group_rows.h"

namespace sansmesh::inline v1 {
namespace {

/// The pieces at each point in ascending order, with the number already used.
class PiecesAt {
 public:
  PiecesAt(const std::vector<SectionPiece>& pieces, std::size_t places, std::uint32_t SectionPiece::*end)
      : at_(group_rows(places,
                       [&](const auto& visit) {
                         for (std::size_t i = 0; i < pieces.size(); ++i) visit(pieces[i].*end, i);
                       })),
        next_(places) {}

  std::size_t count(std::uint32_t place) const { return at_[place].size(); }

  /// The lowest unused piece at a point; kNone if there is none.
  std::uint32_t unused(std::uint32_t place, const std::vector<std::uint8_t>& used) {
    const std::span<const std::uint32_t> pieces = at_[place];
    std::uint32_t& next = next_[place];
    while (next < pieces.size() && used[pieces[next]]) ++next;
    return next < pieces.size() ? pieces[next] : kNone;
  }

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

 private:
  Adjacency at_;
  std::vector<std::uint32_t> next_;  ///< per point: number of pieces found to be used
};

}  // namespace

std::vector<SectionChain> chain_pieces(const std::vector<SectionPiece>& pieces, std::size_t places) {
  PiecesAt leaving(pieces, places, &SectionPiece::from), arriving(pieces, places, &SectionPiece::to);
  std::vector<std::uint8_t> used(pieces.size());
  std::vector<SectionChain> chains;

  const auto walk = [&](std::uint32_t start) {
    SectionChain chain;
    chain.places.push_back(start);
    std::size_t forward = 0, backward = 0;
    for (std::uint32_t place = start;;) {
      std::uint32_t piece = leaving.unused(place, used);
      if (piece != PiecesAt::kNone) {
        ++forward;
        place = pieces[piece].to;
      } else {
        piece = arriving.unused(place, used);
        if (piece == PiecesAt::kNone) break;
        ++backward;
        place = pieces[piece].from;
      }
      used[piece] = 1;
      if (place == start) {
        chain.closed = true;
        break;
      }
      chain.places.push_back(place);
    }
    if (backward > forward) std::reverse(chain.places.begin(), chain.places.end());
    chains.push_back(std::move(chain));
  };

  // Open chains first: start at points where a chain must begin, then at those where one must end; the rest are closed.
  const auto odd = [&](std::uint32_t place) { return (leaving.count(place) + arriving.count(place)) % 2 == 1; };
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (const std::uint32_t p = pieces[i].from; !used[i] && odd(p) && leaving.count(p) > arriving.count(p)) walk(p);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const std::uint32_t p : {pieces[i].from, pieces[i].to})
      if (!used[i] && odd(p)) walk(p);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (!used[i]) walk(pieces[i].from);
  return chains;
}

}  // namespace sansmesh::inline v1
