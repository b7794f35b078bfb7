#include "sansmesh/triangulation/j1a.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "balanced_tree.h"
#include "sansmesh/error.h"
#include "sansmesh/triangulation/block_tree_view.h"

namespace sansmesh::inline v1 {
namespace {

std::int64_t factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

template <int N>
using Corners = std::array<LatticeVertex<N>, N + 1>;

// N! times the signed volume, expanded along the first column of the matrix.
template <std::size_t M>
std::int64_t determinant_of(const std::array<std::array<std::int64_t, M>, M>& m) {
  if constexpr (M == 1) {
    return m[0][0];
  } else {
    std::int64_t sum = 0;
    for (std::size_t row = 0; row < M; ++row) {
      if (m[row][0] == 0) continue;
      std::array<std::array<std::int64_t, M - 1>, M - 1> minor;
      for (std::size_t i = 0; i + 1 < M; ++i)
        for (std::size_t k = 0; k + 1 < M; ++k) minor[i][k] = m[i < row ? i : i + 1][k + 1];
      sum += (row % 2 == 0 ? 1 : -1) * m[row][0] * determinant_of<M - 1>(minor);
    }
    return sum;
  }
}

template <int N>
std::int64_t determinant(const Corners<N>& v) {
  std::array<std::array<std::int64_t, N>, N> m;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t k = 0; k < N; ++k) m[i][k] = v[i + 1][k] - v[0][k];
  return determinant_of<N>(m);
}

// Divides by a common unit, so that products fit.
template <int N>
Corners<N> coarser(Corners<N> v, std::int64_t unit) {
  for (auto& p : v)
    for (auto& c : p) {
      EXPECT_EQ(c % unit, 0);
      c /= unit;
    }
  return v;
}

template <int N>
bool contains(const Corners<N>& v, const LatticeVertex<N>& p) {
  const std::int64_t whole = determinant<N>(v);
  for (std::size_t i = 0; i <= N; ++i) {
    Corners<N> part = v;
    part[i] = p;
    const std::int64_t d = determinant<N>(part);
    if (d != 0 && (d > 0) != (whole > 0)) return false;
  }
  return true;
}

template <int N>
using Face = std::array<LatticeVertex<N>, N>;

template <int N>
Face<N> face_opposite(const Corners<N>& v, int i) {
  Face<N> face;
  std::size_t n = 0;
  for (std::size_t k = 0; k <= N; ++k)
    if (static_cast<int>(k) != i) face[n++] = v[k];
  std::sort(face.begin(), face.end());
  return face;
}

template <int N>
bool on_boundary(const Face<N>& face, const BlockCell<N>& roots) {
  for (std::size_t k = 0; k < N; ++k)
    for (const std::int64_t wall : {std::int64_t{0}, roots[k] * kLatticeEdge})
      if (std::all_of(face.begin(), face.end(), [&](const auto& p) { return p[k] == wall; })) return true;
  return false;
}

// Checks the theorems on one tree: filling, conformity, pivots against brute force, canonical tuples. Returns the
// number of simplices for each h.
template <int N>
std::array<std::size_t, N + 1> check_tree(const BlockView<N>& tree,
                                          const std::vector<std::pair<int, BlockCell<N>>>& leaves,
                                          const BlockCell<N>& roots) {
  struct Use {
    Simplex<N> simplex;
    int opposite;
  };
  std::array<std::size_t, N + 1> kinds{};
  std::map<Face<N>, std::vector<Use>> uses;
  std::set<decltype(key(Simplex<N>{}))> all;
  for (const auto& [level, cell] : leaves) {
    const std::vector<Simplex<N>> simplices = simplices_of<N>(tree, level, cell);
    const std::int64_t edge = kLatticeEdge >> level, unit = edge / 4;
    std::int64_t volume = 0;
    bool refined = false;
    for (const Simplex<N>& s : simplices) {
      EXPECT_TRUE(is_valid(tree, s));
      EXPECT_TRUE(all.insert(key(s)).second);
      refined = refined || s.steps != N;
      ++kinds[s.steps];
      const Corners<N> v = vertices(s);
      for (const auto& p : v)
        for (std::size_t k = 0; k < N; ++k) {
          EXPECT_GE(p[k], cell[k] * edge);
          EXPECT_LE(p[k], (cell[k] + 1) * edge);
        }
      Corners<N> scaled = v;
      for (auto& p : scaled)
        for (std::size_t k = 0; k < N; ++k) p[k] -= cell[k] * edge;
      const std::int64_t d = determinant<N>(coarser<N>(scaled, unit));
      EXPECT_EQ(d > 0 ? 1 : -1, orientation(s));
      EXPECT_NE(d, 0);
      volume += std::abs(d);
      for (int i = 0; i <= N; ++i) uses[face_opposite<N>(v, i)].push_back({s, i});
    }
    EXPECT_EQ(volume, factorial(N) * static_cast<std::int64_t>(std::pow(4, N)));
    if (!refined) {
      EXPECT_EQ(simplices.size(), static_cast<std::size_t>((1 << N) * factorial(N)));
    }
  }

  for (const auto& [face, users] : uses) {
    const bool boundary = on_boundary<N>(face, roots);
    EXPECT_EQ(users.size(), boundary ? 1u : 2u);
    if (users.size() != (boundary ? 1u : 2u)) continue;
    for (std::size_t n = 0; n < users.size(); ++n) {
      const auto& [s, i] = users[n];
      const std::optional<Simplex<N>> other = pivot(tree, s, i);
      EXPECT_EQ(other.has_value(), !boundary);
      if (!other || boundary) continue;
      EXPECT_EQ(*other, users[1 - n].simplex);
      EXPECT_TRUE(is_valid(tree, *other));
      EXPECT_EQ(pivot(tree, *other, i), s);
      const Corners<N> v = vertices(s), w = vertices(*other);
      for (int k = 0; k <= N; ++k) EXPECT_EQ(v[static_cast<std::size_t>(k)] == w[static_cast<std::size_t>(k)], k != i);
      // The two are on opposite sides.
      EXPECT_EQ(orientation(s), -orientation(*other));
    }
  }
  return kinds;
}

TEST(J1a, TilesRandomTreesInThePlane) {
  std::array<std::size_t, 2> seen{};
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const BlockCell<2> roots = seed % 3 == 0 ? BlockCell<2>{2, 3} : one_root<2>();
    const auto tree = BalancedTree<2>::random(seed, roots, 5, 2 + static_cast<int>(seed % 7));
    const auto kinds = check_tree<2>(tree, tree.leaves(), roots);
    seen[0] += kinds[1], seen[1] += kinds[2];
  }
  for (const std::size_t n : seen) EXPECT_GT(n, 1000u);
}

TEST(J1a, TilesRandomTreesInSpace) {
  std::array<std::size_t, 3> seen{};
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const BlockCell<3> roots = seed % 4 == 0 ? BlockCell<3>{2, 1, 2} : one_root<3>();
    const auto tree = BalancedTree<3>::random(seed, roots, 5, 3 + static_cast<int>(seed % 5));
    const auto kinds = check_tree<3>(tree, tree.leaves(), roots);
    for (std::size_t h = 0; h < 3; ++h) seen[h] += kinds[h + 1];
  }
  for (const std::size_t n : seen) EXPECT_GT(n, 3000u);
}

TEST(J1a, TilesRandomTreesInSpaceAndTime) {
  std::array<std::size_t, 4> seen{};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const BlockCell<4> roots = seed == 3 ? BlockCell<4>{1, 1, 2, 1} : one_root<4>();
    const auto tree = BalancedTree<4>::random(seed, roots, 3, 1 + static_cast<int>(seed % 2));
    const auto kinds = check_tree<4>(tree, tree.leaves(), roots);
    for (std::size_t h = 0; h < 4; ++h) seen[h] += kinds[h + 1];
  }
  for (const std::size_t n : seen) EXPECT_GT(n, 1000u);
}

// Sets of refined faces and edges: each of the 26 neighbours subdivided alone, then random sets, few and many.
TEST(J1a, TilesTransitionBlocks) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 600; ++trial) {
    BalancedTree<3> tree({3, 3, 3});
    const unsigned some = trial < 27 ? 1u << trial : static_cast<unsigned>(random());
    const unsigned thin = trial % 2 == 0 ? ~0u : static_cast<unsigned>(random());
    for (int n = 0; n < 27; ++n)
      if (n != 13 && ((some & thin) >> n & 1u)) tree.subdivide(0, {n % 3, n / 3 % 3, n / 9});
    const std::vector<Simplex<3>> simplices = simplices_of<3>(tree, 0, {1, 1, 1});
    std::int64_t volume = 0;
    for (const Simplex<3>& s : simplices) {
      volume += std::abs(determinant<3>(coarser<3>(vertices(s), kLatticeEdge / 4)));
      for (int i = 0; i <= 3; ++i) {
        const auto other = pivot<3>(tree, s, i);
        ASSERT_TRUE(other.has_value());
        EXPECT_TRUE(is_valid(tree, *other));
        EXPECT_EQ(pivot(tree, *other, i), s);
        const auto v = vertices(s), w = vertices(*other);
        for (std::size_t k = 0; k <= 3; ++k) EXPECT_EQ(v[k] == w[k], static_cast<int>(k) != i);
      }
    }
    EXPECT_EQ(volume, 6 * 64);
  }
}

// In four dimensions: each of the 64 neighbours that share more than a corner subdivided alone, then random sets.
TEST(J1a, TilesTransitionBlocksOfFourDimensions) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 81 + 20; ++trial) {
    BalancedTree<4> tree({3, 3, 3, 3});
    for (int n = 0; n < 81; ++n) {
      if (n == 40 || (trial < 81 ? n != trial : random() % (trial % 2 == 0 ? 2 : 8) != 0)) continue;
      tree.subdivide(0, {n % 3, n / 3 % 3, n / 9 % 3, n / 27});
    }
    const std::vector<Simplex<4>> simplices = simplices_of<4>(tree, 0, {1, 1, 1, 1});
    std::int64_t volume = 0;
    for (const Simplex<4>& s : simplices) {
      volume += std::abs(determinant<4>(coarser<4>(vertices(s), kLatticeEdge / 4)));
      for (int i = 0; i <= 4; ++i) {
        const auto other = pivot<4>(tree, s, i);
        ASSERT_TRUE(other.has_value());
        ASSERT_EQ(pivot(tree, *other, i), s);
        const auto v = vertices(s), w = vertices(*other);
        for (std::size_t k = 0; k <= 4; ++k) ASSERT_EQ(v[k] == w[k], static_cast<int>(k) != i);
      }
    }
    EXPECT_EQ(volume, 24 * 256);
  }
}

// The library's tree in N dimensions: deep towards random corners, then balanced.
template <int N>
void check_own_tree(unsigned seed, int depth) {
  std::mt19937 random(seed);
  BlockTreeN<N> blocks;
  std::size_t at = 0;
  for (int level = 0; level < depth; ++level) at = blocks.subdivide(at) + random() % BlockTreeN<N>::kChildren;
  blocks.balance();
  const BlockTreeNView<N> tree(blocks);
  std::vector<std::pair<int, BlockCell<N>>> leaves;
  double volume = 0;
  for (const std::uint32_t b : blocks.leaves()) {
    BlockCell<N> cell;
    for (std::size_t k = 0; k < N; ++k) cell[k] = static_cast<std::int32_t>(blocks[b].cell[k]);
    leaves.push_back({blocks[b].level, cell});
    volume += std::ldexp(1.0, -N * blocks[b].level);
    // Points of the leaf are located in it.
    std::array<double, N> x;
    for (std::size_t k = 0; k < N; ++k)
      x[k] = std::ldexp(cell[k] + static_cast<double>(random()) / 4294967296.0, -static_cast<int>(blocks[b].level));
    const auto found = locate<N>(tree, x);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->cell, cell);
    EXPECT_EQ(found->level, blocks[b].level);
    // Neighbours differ by at most one level.
    int size = 1;
    for (int k = 0; k < N; ++k) size *= 3;
    for (int index = 0, rest = 0; index < size; ++index) {
      typename BlockTreeN<N>::Cell other;
      rest = index;
      for (std::size_t k = 0; k < N; ++k, rest /= 3) other[k] = cell[k] + rest % 3 - 1;
      const std::int64_t n = blocks.find(blocks[b].level, other);
      if (n >= 0) {
        EXPECT_GE(blocks[static_cast<std::size_t>(n)].level + 1, blocks[b].level);
      }
    }
  }
  EXPECT_EQ(volume, 1);
  check_tree<N>(tree, leaves, one_root<N>());
}

TEST(J1a, TilesTheTreesOfTheLibraryInAllDimensions) {
  check_own_tree<2>(1, 7);
  check_own_tree<3>(2, 4);
  check_own_tree<4>(3, 2);
}

// Exactly one simplex contains a point inside; all simplices of a leaf are tested.
template <int N>
void check_covering(unsigned seed) {
  const auto tree = BalancedTree<N>::random(seed, one_root<N>(), 3, 2);
  std::mt19937 random(seed);
  constexpr std::int64_t kUnit = kLatticeEdge >> 13;
  for (const auto& [level, cell] : tree.leaves()) {
    if (random() % 4 != 0) continue;
    const std::int64_t edge = (kLatticeEdge >> level) / kUnit;
    LatticeVertex<N> p;
    std::array<double, N> x;
    for (std::size_t k = 0; k < N; ++k) {
      p[k] = cell[k] * edge + 1 + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(edge - 1));
      x[k] = std::ldexp(static_cast<double>(p[k]), -13);
    }
    std::size_t closed = 0, open = 0;
    for (const Simplex<N>& s : simplices_of<N>(tree, level, cell)) {
      const Corners<N> v = coarser<N>(vertices(s), kUnit);
      if (!contains<N>(v, p)) continue;
      ++closed;
      bool within = true;
      for (std::size_t i = 0; i <= N; ++i) {
        Corners<N> part = v;
        part[i] = p;
        within = within && determinant<N>(part) != 0;
      }
      open += within;
      if (within) {
        EXPECT_EQ(locate<N>(tree, x), s);
      }
    }
    EXPECT_GE(closed, 1u);
    EXPECT_LE(open, 1u);
    EXPECT_EQ(open == 1, closed == 1);
  }
}

TEST(J1a, EveryPointLiesInOneSimplex) {
  check_covering<2>(1);
  check_covering<3>(2);
  check_covering<4>(3);
}

TEST(J1a, TilesTheLibrarysOwnTree) {
  BlockTree blocks({-1, -2, -3}, 8);
  std::mt19937 random(11);
  for (int n = 0; n < 3; ++n) {
    std::size_t at = 0;
    for (int level = 0; level < 4; ++level) at = blocks.subdivide(at) + random() % 8;
  }
  blocks.balance();
  const BlockTreeView tree(blocks);
  std::vector<std::pair<int, BlockCell<3>>> leaves;
  for (const std::uint32_t b : blocks.leaves()) {
    const auto& cell = blocks[b].cell;
    leaves.push_back(
        {blocks[b].level,
         {static_cast<std::int32_t>(cell[0]), static_cast<std::int32_t>(cell[1]), static_cast<std::int32_t>(cell[2])}});
    const auto center = vertices(simplices_of<3>(tree, leaves.back().first, leaves.back().second).front())[0];
    EXPECT_EQ(tree.position(center), blocks.block_center(b));
    const auto found = locate<3>(tree, tree.to_lattice(blocks.block_center(b)));
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->cell, leaves.back().second);
  }
  check_tree<3>(tree, leaves, one_root<3>());
}

// A tuple is valid if and only if the enumeration lists it.
template <int N>
void check_validity(const BlockView<N>& tree, int level, const BlockCell<N>& cell) {
  std::set<decltype(key(Simplex<N>{}))> listed;
  for (const Simplex<N>& s : simplices_of<N>(tree, level, cell)) listed.insert(key(s));
  Simplex<N> s;
  s.cell = cell;
  s.level = static_cast<std::uint8_t>(level);
  std::size_t valid = 0;
  const int combinations = static_cast<int>(std::pow(N, N) * std::pow(2, N) * std::pow(3, N)) * (N + 2);
  for (int c = 0; c < combinations; ++c) {
    int rest = c;
    for (std::size_t k = 0; k < N; ++k) s.axis[k] = static_cast<std::uint8_t>(rest % N), rest /= N;
    for (std::size_t k = 0; k < N; ++k) s.sign[k] = rest % 2 ? 1 : -1, rest /= 2;
    for (std::size_t k = 0; k < N; ++k) s.extra[k] = static_cast<std::int8_t>(rest % 3 - 1), rest /= 3;
    s.steps = static_cast<std::uint8_t>(rest);
    const bool is = is_valid(tree, s);
    EXPECT_EQ(is, listed.count(key(s)) > 0);
    valid += is;
  }
  EXPECT_EQ(valid, listed.size());
  s.sign[0] = 0;
  EXPECT_FALSE(is_valid(tree, s));
}

TEST(J1a, ValidTuplesAreThoseListed) {
  const auto plane = BalancedTree<2>::random(3, {1, 1}, 5, 3);
  for (const auto& [level, cell] : plane.leaves()) check_validity<2>(plane, level, cell);
  const auto space = BalancedTree<3>::random(6, {1, 1, 1}, 3, 1);
  int n = 0;
  for (const auto& [level, cell] : space.leaves())
    if (n++ % 5 == 0) check_validity<3>(space, level, cell);
  Simplex<3> elsewhere = simplices_of<3>(space, space.leaves()[0].first, space.leaves()[0].second)[0];
  elsewhere.cell[0] = -1;
  EXPECT_FALSE(is_valid(space, elsewhere));
}

template <int N>
void check_locate(unsigned seed, const BlockCell<N>& roots) {
  const auto tree = BalancedTree<N>::random(seed, roots, N < 4 ? 5 : 3, 3);
  std::mt19937 random(seed);
  // Points on grids of different coarseness: many on faces, edges, vertices and the boundary.
  constexpr int kBits = N < 4 ? 15 : 12;  // products of N coordinates fit
  constexpr std::int64_t kUnit = kLatticeEdge >> kBits;
  for (int trial = 0; trial < 3000; ++trial) {
    const int coarse = trial % (kBits - 2);
    std::array<double, N> x;
    LatticeVertex<N> p;
    for (std::size_t k = 0; k < N; ++k) {
      const std::int64_t steps = std::int64_t{roots[k]} << (kBits - coarse);
      p[k] = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(steps + 1)) << coarse;
      x[k] = std::ldexp(static_cast<double>(p[k]), -kBits);
    }
    const auto s = locate<N>(tree, x);
    ASSERT_TRUE(s.has_value());
    ASSERT_TRUE(is_valid(tree, *s));
    EXPECT_TRUE(contains<N>(coarser<N>(vertices(*s), kUnit), p)) << trial;
  }
}

TEST(J1a, LocatesTheSimplexThatContainsAPoint) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    check_locate<2>(seed, {1, 2});
    check_locate<3>(seed, {1, 1, 1});
    if (seed <= 2) check_locate<4>(seed, {1, 1, 1, 2});
  }
  const auto tree = BalancedTree<2>::random(1, {2, 1}, 4, 2);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const std::array<double, 2>& outside : {std::array{-1e-9, 0.5}, std::array{2.1, 0.5}, std::array{0.5, 1.0000001},
                                               std::array{nan, 0.5}, std::array{0.5, inf}, std::array{1e300, 0.5}})
    EXPECT_FALSE(locate<2>(tree, outside).has_value());
}

TEST(J1a, RefusesWhatIsNoSimplex) {
  const auto tree = BalancedTree<3>::random(1, {1, 1, 1}, 2, 1);
  EXPECT_THROW(simplices_of<3>(tree, 0, {0, 0, 0}), ArgumentError);
  EXPECT_THROW(simplices_of<3>(tree, 1, {2, 0, 0}), ArgumentError);
  EXPECT_THROW(simplices_of<3>(tree, -1, {0, 0, 0}), ArgumentError);
  const auto [level, cell] = tree.leaves().front();
  const auto s = simplices_of<3>(tree, level, cell).front();
  EXPECT_THROW(pivot<3>(tree, s, -1), ArgumentError);
  EXPECT_THROW(pivot<3>(tree, s, 4), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
