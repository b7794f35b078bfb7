#include "sansmesh/polygonize/lattice/lattice.h"
#include "support/sanitizers.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace sansmesh::inline v1 {
namespace {

std::array<int, 3> point(std::uint8_t slot) { return {slot % 5, slot / 5 % 5, slot / 25}; }

int six_volumes(const BlockPattern& p, const std::array<std::uint8_t, 4>& t) {
  int m[3][3];
  const auto o = point(p.slots[t[0]]);
  for (std::size_t r = 0; r < 3; ++r) {
    const auto v = point(p.slots[t[r + 1]]);
    for (std::size_t c = 0; c < 3; ++c) m[r][c] = v[c] - o[c];
  }
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

TEST(BlockPattern, SimplicesFillTheBlockExactly) {
  PatternTable table;
  std::mt19937 generator(1);
  EXPECT_EQ(table.pattern({}).tets.size(), 48u);  // 2ⁿ n!
  for (int trial = 0; trial < 200; ++trial) {
    // A refined face refines its edges.
    const auto some = static_cast<std::uint32_t>(generator()), few = some & static_cast<std::uint32_t>(generator());
    BlockRefinement r{static_cast<std::uint32_t>(generator() & 63u), few & 4095u};
    for (unsigned axis = 0; axis < 3; ++axis)
      for (unsigned bit = 0; bit < 4; ++bit) {
        const unsigned p = axis == 0 ? 1 : 0, q = axis == 2 ? 1 : 2;
        if ((r.faces >> (2 * p + (bit & 1)) & 1u) || (r.faces >> (2 * q + (bit >> 1)) & 1u))
          r.edges |= 1u << (4 * axis + bit);
      }
    const BlockPattern& pattern = table.pattern(r);
    int volume = 0;
    for (const auto& t : pattern.tets) {
      const int v = six_volumes(pattern, t);
      ASSERT_GT(v, 0);
      volume += v;
    }
    EXPECT_EQ(volume, 6 * 64);
  }
}

BlockTree random_tree(unsigned seed, int depth) {
  std::mt19937 generator(seed);
  BlockTree tree({0, 0, 0}, 1);
  for (std::size_t b = 0; b < tree.size(); ++b)
    if (tree[b].level < depth && (tree[b].level < 2 || generator() % 5 == 0)) tree.subdivide(b);
  tree.balance();
  return tree;
}

TEST(Lattice, SimplicesOfARandomTreeShareEveryInnerFaceByTwo) {
  SANSMESH_NOT_SANITIZED("counts faces; others visit trees, too");
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const BlockTree tree = random_tree(seed, 5);
    LatticeNumbering numbering;
    PatternTable table;
    std::map<std::array<std::uint32_t, 3>, int> faces;
    for (const std::uint32_t leaf : tree.leaves()) {
      const BlockPattern& pattern = table.pattern(refinement_of(tree, leaf));
      const std::uint32_t edge = 2u << (tree.depth() - tree[leaf].level);
      std::vector<std::uint32_t> number;
      for (const std::uint8_t s : pattern.slots) {
        LatticePoint p;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t quarters = static_cast<std::uint32_t>(point(s)[k]) * edge;
          ASSERT_EQ(quarters % 4, 0u);
          p[k] = tree[leaf].cell[k] * edge + quarters / 4;
        }
        number.push_back(numbering.number(p));
      }
      for (const auto& t : pattern.tets)
        for (std::size_t out = 0; out < 4; ++out) {
          std::array<std::uint32_t, 3> face{};
          for (std::size_t k = 0, m = 0; k < 4; ++k)
            if (k != out) face[m++] = number[t[k]];
          std::sort(face.begin(), face.end());
          ++faces[face];
        }
    }
    const std::uint32_t top = 2u << tree.depth();
    for (const auto& [face, count] : faces) {
      bool border = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto c = [&](std::size_t i) { return numbering.points()[face[i]][k]; };
        border = border || (c(0) == c(1) && c(1) == c(2) && (c(0) == 0 || c(0) == top));
      }
      ASSERT_EQ(count, border ? 1 : 2);
    }
  }
}

TEST(BlockTree, BalanceLeavesNoNeighboursTwoLevelsApart) {
  BlockTree tree({0, 0, 0}, 1);
  std::size_t at = 0;
  for (int l = 0; l < 7; ++l) at = tree.subdivide(at) + 7;  // always the far corner, ending next to the root's centre
  tree.balance();
  const std::vector<std::uint32_t> leaves = tree.leaves();
  double volume = 0;
  for (const std::uint32_t leaf : leaves) {
    const auto& b = tree[leaf];
    volume += std::pow(0.125, b.level);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const std::int64_t n = tree.find(b.level, std::int64_t{b.cell[0]} + dx, std::int64_t{b.cell[1]} + dy,
                                           std::int64_t{b.cell[2]} + dz);
          if (n >= 0) {
            EXPECT_GE(tree[static_cast<std::size_t>(n)].level, b.level - 1);
          }
        }
  }
  EXPECT_DOUBLE_EQ(volume, 1);
}

TEST(LatticeNumbering, GivesEachPointOneNumber) {
  LatticeNumbering numbering;
  std::mt19937 generator(6);
  std::map<LatticePoint, std::uint32_t> seen;
  for (int i = 0; i < 20000; ++i) {
    const auto random = [&](unsigned below) { return static_cast<std::uint32_t>(generator() % below); };
    const LatticePoint p{random(64), random(64), random(8) * 8};
    const auto [it, fresh] = seen.try_emplace(p, static_cast<std::uint32_t>(seen.size()));
    ASSERT_EQ(numbering.number(p), it->second);
    ASSERT_EQ(numbering.points()[it->second], p);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
