#include "sansmesh/polygonize/pieces/piece_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/polygonize/lattice/lattice.h"
#include "sansmesh/polygonize/lattice/lattice_clearance.h"
#include "sansmesh/polygonize/pieces/piece_cutter_cells-inl.h"
#include "sansmesh/polygonize/pieces/piece_cutter_simplex-inl.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kChunkOfLeaves = 512;

/// Distances to other sheets that cross the same lattice edge.
void find_room(CutPieces& cut, const std::vector<CutName>& names) {
  std::vector<KeyIndex> on_edges;
  for (std::uint32_t v = 0; v < names.size(); ++v)
    if (names[v][0] != kNoName && names[v][2] == kNoName)
      on_edges.push_back({std::uint64_t{names[v][0]} << 32 | names[v][1], v});
  parallel_sort(on_edges);
  for (std::size_t i = 0, j; i < on_edges.size(); i = j) {
    for (j = i + 1; j < on_edges.size() && on_edges[j].key == on_edges[i].key; ++j) {
    }
    for (std::size_t a = i; a < j; ++a)
      for (std::size_t b = a + 1; b < j; ++b) {
        CutPieces::Vertex &v = cut.vertices[on_edges[a].index], &w = cut.vertices[on_edges[b].index];
        const auto distance = static_cast<float>(norm(v.x - w.x));
        v.room = std::min(v.room, distance);
        w.room = std::min(w.room, distance);
      }
  }
}

/// Lattice vertices of all leaves.
struct NumberedLeaves {
  PatternTable patterns;
  std::vector<const BlockPattern*> pattern;
  std::vector<std::size_t> first;      ///< one more than leaves: range of each in `numbers`
  std::vector<std::uint32_t> numbers;  ///< in the order of the patterns' slots
  std::vector<Vec3> position;          ///< per lattice vertex

  NumberedLeaves(const PieceExpression& field, const PieceBlocks& blocks)
      : pattern(blocks.leaves.size()), first(blocks.leaves.size() + 1, 0) {
    const BlockTree& tree = blocks.tree;
    const std::size_t n = blocks.leaves.size();
    std::vector<BlockRefinement> refinement(n);
    parallel_for(0, n, 1024, [&](std::size_t i) { refinement[i] = refinement_of(tree, blocks.leaves[i].block); });
    for (std::size_t i = 0; i < n; ++i) {
      pattern[i] = &patterns.pattern(refinement[i]);
      first[i + 1] = first[i] + pattern[i]->slots.size();
    }
    numbers.reserve(first[n]);
    LatticeNumbering numbering;
    for (std::size_t i = 0; i < n; ++i)
      for (const std::uint8_t slot : pattern[i]->slots)
        numbers.push_back(numbering.number(slot_point(tree, blocks.leaves[i].block, slot)));
    position = clear_lattice(field, blocks, numbers, first, numbering.points());
  }

  std::span<const std::uint32_t> of(std::size_t leaf) const {
    return std::span(numbers).subspan(first[leaf], first[leaf + 1] - first[leaf]);
  }
};

/// The cuts of all leaves, in chunks.
std::vector<CutChunk> cut_leaves(const PieceExpression& field, const PieceBlocks& blocks, Progress& progress) {
  NumberedLeaves leaves(field, blocks);
  const BlockTree& tree = blocks.tree;
  const std::size_t n = blocks.leaves.size();
  const double quantum = std::ldexp(blocks.scale, -kValueBits);
  const PlainPattern plain(leaves.patterns.pattern({}));
  std::vector<CutChunk> found((n + kChunkOfLeaves - 1) / kChunkOfLeaves);
  // Visits the leaves of a chunk with the positions of their vertices.
  const auto for_leaves = [&](std::size_t c, auto&& leaf) {
    PieceCutter<kUsualBits> cutter(field, blocks, quantum, plain, found[c]);
    std::vector<Vec3> x;
    for (std::size_t i = c * kChunkOfLeaves; i < std::min(n, (c + 1) * kChunkOfLeaves); ++i) {
      progress.check();
      x.clear();
      for (const std::uint32_t v : leaves.of(i)) x.push_back(leaves.position[v]);
      leaf(cutter, i, x);
    }
  };
  std::vector<CellStates> cells(n);
  parallel_for(0, found.size(), 1, [&](std::size_t c) {
    for_leaves(c, [&](PieceCutter<kUsualBits>& cutter, std::size_t i, std::span<const Vec3> x) {
      cells[i] = cutter.look(i, *leaves.pattern[i], x);
    });
  });
  std::vector<std::uint32_t> leaf_of(tree.size(), kNoName);
  for (std::uint32_t i = 0; i < n; ++i) leaf_of[blocks.leaves[i].block] = i;
  // Cells of the block beside it: none where there is no surface, all where it has another size.
  const auto cells_beside = [&](std::size_t i, std::size_t face) -> CellStates {
    const BlockTree::Block& b = tree[blocks.leaves[i].block];
    std::array<std::int64_t, 3> at{b.cell[0], b.cell[1], b.cell[2]};
    at[face / 2] += face % 2 ? 1 : -1;
    const std::int64_t other = tree.find(b.level, at[0], at[1], at[2]);
    if (other < 0 || leaf_of[static_cast<std::size_t>(other)] == kNoName) return 0;
    return tree[static_cast<std::size_t>(other)].level == b.level ? cells[leaf_of[static_cast<std::size_t>(other)]]
                                                                  : kAllSeveral;
  };
  parallel_for(0, found.size(), 1, [&](std::size_t c) {
    PieceCutter<kManyBits> cutter_of_many(field, blocks, quantum, plain, found[c]);
    for_leaves(c, [&](PieceCutter<kUsualBits>& cutter, std::size_t i, std::span<const Vec3> x) {
      std::array<CellStates, 6> beside{};
      if (leaves.pattern[i] == plain.pattern)
        for (std::size_t face = 0; face < 6; ++face) beside[face] = cells_beside(i, face);
      if (!cutter.cut(i, *leaves.pattern[i], leaves.of(i), x, cells[i], beside))
        cutter_of_many.cut(i, *leaves.pattern[i], leaves.of(i), x, cells[i], beside);
    });
  });
  return found;
}

}  // namespace

CutPieces cut_pieces(const PieceExpression& field, const PieceBlocks& blocks, Progress& progress) {
  for (const PieceBlocks::Leaf& l : blocks.leaves) {
    if (distinct_pieces(std::span(blocks.nodes).subspan(l.first, l.count)) <= kMostPiecesInBlock) continue;
    CutPieces none;
    none.crowded = blocks.tree.block_center(l.block);
    return none;
  }
  progress.begin("cut", (blocks.leaves.size() + kChunkOfLeaves - 1) / kChunkOfLeaves);
  std::vector<CutChunk> found = cut_leaves(field, blocks, progress);
  CutPieces cut;
  CutNames names;
  for (CutChunk& c : found) {
    if (!cut.cracked) cut.cracked = c.cracked;
    std::vector<std::uint32_t> number(c.x.size());
    for (std::size_t v = 0; v < c.x.size(); ++v) {
      const CutName& name = c.names.names()[v];
      number[v] = names.number(name);
      if (number[v] < cut.vertices.size()) {
        CutPieces::Vertex& old = cut.vertices[number[v]];
        old.size = std::min(old.size, c.size[v]);
        old.room = std::min(old.room, c.room[v]);
        continue;
      }
      CutPieces::Vertex vertex;
      vertex.x = c.x[v];
      vertex.size = c.size[v];
      vertex.room = c.room[v];
      // A corner inside a face that belongs to one simplex alone is only on its piece.
      const bool alone = name[0] == kNoName && name[2] != kNoName;
      vertex.piece = alone ? std::array{name[5], kNoName, kNoName} : std::array{name[3], name[4], name[5]};
      cut.vertices.push_back(vertex);
    }
    for (std::size_t t = 0; t < c.triangles.size(); ++t) {
      const Triangle& old = c.triangles[t];
      cut.triangles.push_back({number[old[0]], number[old[1]], number[old[2]]});
      cut.piece.push_back(c.piece[t]);
    }
    c = {};
    progress.advance();
  }
  find_room(cut, names.names());
  progress.finish();
  return cut;
}

}  // namespace sansmesh::inline v1
