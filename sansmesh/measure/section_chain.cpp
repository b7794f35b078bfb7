#include "sansmesh/measure/section_chain.h"

#include <algorithm>
#include <cstddef>

#include "sansmesh/data/group_rows.h"

namespace sansmesh::inline v1 {
namespace {

/// The pieces at each point in ascending order, with the number already used.
class PiecesAt {
 public:
  PiecesAt(const std::vector<SectionPiece>& pieces, std::size_t points, std::uint32_t SectionPiece::*end)
      : at_(group_rows(points,
                       [&](const auto& visit) {
                         for (std::size_t i = 0; i < pieces.size(); ++i) visit(pieces[i].*end, i);
                       })),
        next_(points) {}

  std::size_t count(std::uint32_t point) const { return at_[point].size(); }

  /// The lowest unused piece at a point; kNone if there is none.
  std::uint32_t unused(std::uint32_t point, const std::vector<std::uint8_t>& used) {
    const std::span<const std::uint32_t> pieces = at_[point];
    std::uint32_t& next = next_[point];
    while (next < pieces.size() && used[pieces[next]]) ++next;
    return next < pieces.size() ? pieces[next] : kNone;
  }

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

 private:
  Adjacency at_;
  std::vector<std::uint32_t> next_;  ///< per point: number of pieces found to be used
};

}  // namespace

std::vector<SectionChain> chain_pieces(const std::vector<SectionPiece>& pieces, std::size_t points) {
  PiecesAt leaving(pieces, points, &SectionPiece::from), arriving(pieces, points, &SectionPiece::to);
  std::vector<std::uint8_t> used(pieces.size());
  std::vector<SectionChain> chains;

  const auto walk = [&](std::uint32_t start) {
    SectionChain chain;
    chain.points.push_back(start);
    std::size_t forward = 0, backward = 0;
    for (std::uint32_t point = start;;) {
      std::uint32_t piece = leaving.unused(point, used);
      if (piece != PiecesAt::kNone) {
        ++forward;
        point = pieces[piece].to;
      } else {
        piece = arriving.unused(point, used);
        if (piece == PiecesAt::kNone) break;
        ++backward;
        point = pieces[piece].from;
      }
      used[piece] = 1;
      if (point == start) {
        chain.closed = true;
        break;
      }
      chain.points.push_back(point);
    }
    if (backward > forward) std::reverse(chain.points.begin(), chain.points.end());
    chains.push_back(std::move(chain));
  };

  // Open chains first: start at points where a chain must begin, then at those where one must end; the rest are closed.
  const auto odd = [&](std::uint32_t point) { return (leaving.count(point) + arriving.count(point)) % 2 == 1; };
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
