// Agreement of the tables that cut whole blocks (polygonize/lattice/lattice.h) with the algebra of single simplices.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "sansmesh/polygonize/lattice/lattice.h"
#include "sansmesh/triangulation/block_tree_view.h"

namespace sansmesh::inline v1 {
namespace {

using LatticeCorners = std::array<LatticeVertex<3>, 4>;

TEST(J1aLattice, PatternsAreTheEnumeratedSimplices) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    BlockTree blocks({0, 0, 0}, 1);
    for (int n = 0; n < 4; ++n) {
      std::size_t at = 0;
      for (int level = 0; level < 5; ++level) at = blocks.subdivide(at) + random() % 8;
    }
    blocks.balance();
    const BlockTreeView tree(blocks);
    PatternTable table;
    std::set<std::size_t> sizes;
    for (const std::uint32_t b : blocks.leaves()) {
      const BlockTree::Block& block = blocks[b];
      BlockCell<3> cell;
      for (std::size_t k = 0; k < 3; ++k) cell[k] = static_cast<std::int32_t>(block.cell[k]);
      std::set<LatticeCorners> from_tuples, from_table;
      for (const auto& s : simplices_of<3>(tree, block.level, cell)) {
        LatticeCorners v = vertices(s);
        std::sort(v.begin(), v.end());
        from_tuples.insert(v);
      }
      const std::int64_t quarter = kLatticeEdge >> (block.level + 2);
      const BlockPattern& pattern = table.pattern(refinement_of(blocks, b));
      for (const auto& t : pattern.tets) {
        LatticeCorners v;
        for (std::size_t i = 0; i < 4; ++i) {
          const int slot = pattern.slots[t[i]];
          v[i] = {(4 * cell[0] + slot % 5) * quarter, (4 * cell[1] + slot / 5 % 5) * quarter,
                  (4 * cell[2] + slot / 25) * quarter};
        }
        std::sort(v.begin(), v.end());
        from_table.insert(v);
      }
      ASSERT_EQ(from_tuples, from_table);
      sizes.insert(from_table.size());
    }
    EXPECT_GT(sizes.size(), 4u);  // blocks of several kinds
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
