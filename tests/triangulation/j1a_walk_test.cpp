#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <span>
#include <vector>

#include "balanced_tree.h"
#include "sansmesh/triangulation/j1a.h"

namespace sansmesh::inline v1 {
namespace {

template <int N>
void check_walk(unsigned seed, int depth) {
  const auto tree = BalancedTree<N>::random(seed, one_root<N>(), depth, 4);
  const double radius = 0.37 * static_cast<double>(kLatticeEdge), middle = 0.503 * static_cast<double>(kLatticeEdge);
  const auto is_inside = [&](const LatticeVertex<N>& v) {
    double t = 0;
    for (const std::int64_t c : v) t += (static_cast<double>(c) - middle) * (static_cast<double>(c) - middle);
    return t < radius * radius;
  };
  std::set<decltype(key(Simplex<N>{}))> crossing;
  std::vector<Simplex<N>> everything;
  for (const auto& [level, cell] : tree.leaves())
    for (const Simplex<N>& s : simplices_of<N>(tree, level, cell)) {
      everything.push_back(s);
      int in = 0;
      for (const auto& v : vertices(s)) in += is_inside(v);
      if (in > 0 && in <= N) crossing.insert(key(s));
    }
  ASSERT_GT(crossing.size(), 20u);

  std::set<LatticeVertex<N>> asked;
  const InsideTest<N> inside = [&](std::span<const LatticeVertex<N>> v, std::span<std::uint8_t> result) {
    ASSERT_EQ(v.size(), result.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
      EXPECT_TRUE(asked.insert(v[i]).second);
      result[i] = is_inside(v[i]);
    }
  };
  // The walk from one simplex reaches the whole sphere.
  const auto first =
      std::find_if(everything.begin(), everything.end(), [&](const auto& s) { return crossing.count(key(s)); });
  std::vector<Simplex<N>> walked = walk_crossing<N>(tree, std::span(&*first, 1), inside);
  std::set<decltype(key(Simplex<N>{}))> reached;
  for (const auto& s : walked) EXPECT_TRUE(reached.insert(key(s)).second);
  EXPECT_EQ(reached, crossing);
  // More seeds than needed, and seeds that do not cross, change nothing.
  asked.clear();
  EXPECT_EQ(walk_crossing<N>(tree, everything, inside).size(), crossing.size());
  asked.clear();
  EXPECT_TRUE(walk_crossing<N>(tree, {}, inside).empty());
}

TEST(J1aWalk, ReachesAllOfAConnectedLevelSet) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    check_walk<2>(seed, 5);
    check_walk<3>(seed, 4);
    if (seed == 1) check_walk<4>(seed, 2);
  }
}

TEST(J1aWalk, StopsAtTheBoundaryAndStaysOnItsComponent) {
  // Two parallel planes through the domain: a seed on one does not reach the other.
  const auto tree = BalancedTree<3>::random(2, {1, 1, 1}, 4, 5);
  const InsideTest<3> slab = [](std::span<const LatticeVertex<3>> v, std::span<std::uint8_t> result) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double z = static_cast<double>(v[i][2]) / static_cast<double>(kLatticeEdge);
      result[i] = z > 0.2 && z < 0.8;
    }
  };
  std::vector<Simplex<3>> everything, lower, upper;
  for (const auto& [level, cell] : tree.leaves())
    for (const auto& s : simplices_of<3>(tree, level, cell)) everything.push_back(s);
  const auto both = walk_crossing<3>(tree, everything, slab);
  for (const auto& s : both) (vertices(s)[0][2] < kLatticeEdge / 2 ? lower : upper).push_back(s);
  for (const auto* half : {&lower, &upper}) {
    ASSERT_FALSE(half->empty());
    std::set<decltype(key(Simplex<3>{}))> expected, reached;
    for (const auto& s : *half) expected.insert(key(s));
    for (const auto& s : walk_crossing<3>(tree, std::span(*half).first(1), slab)) reached.insert(key(s));
    EXPECT_EQ(reached, expected);
  }
}
}  // namespace
}  // namespace sansmesh::inline v1
