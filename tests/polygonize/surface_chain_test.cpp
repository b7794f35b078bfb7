#include "sansmesh/polygonize/surface_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

ChainVertex v(std::uint32_t a) { return {a, a}; }

std::vector<ChainTriangle> tetrahedron(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {{v(a), v(b), v(c)}, {v(a), v(d), v(b)}, {v(b), v(d), v(c)}, {v(a), v(c), v(d)}};
}

test::Topology check(const SurfaceChain& chain) {
  TriangleMesh mesh;
  mesh.vertices.resize(chain.vertices.size());
  mesh.triangles = chain.triangles;
  return test::topology_of(mesh);
}

TEST(SurfaceChain, CancelsSheetsFoldedFlat) {
  std::vector<std::uint8_t> merged(8, 1);
  const SurfaceChain chain = make_surface_chain({[](const ChainSource::Flags&, const ChainSource::Flags&) {
                                                   auto t = tetrahedron(0, 1, 2, 3);
                                                   t.push_back({v(4), v(5), v(6)});
                                                   t.push_back({v(5), v(4), v(6)});
                                                   return t;
                                                 },
                                                 {}},
                                                merged);
  EXPECT_EQ(chain.triangles.size(), 4u);
  EXPECT_EQ(chain.vertices.size(), 4u);
  EXPECT_TRUE(check(chain).closed_manifold());
}

TEST(SurfaceChain, SeparatesSheetsThatTouchInAVertex) {
  std::vector<std::uint8_t> merged(8, 1);
  const SurfaceChain chain = make_surface_chain({[](const ChainSource::Flags&, const ChainSource::Flags&) {
                                                   auto t = tetrahedron(0, 1, 2, 3);
                                                   for (const auto& s : tetrahedron(0, 4, 5, 6)) t.push_back(s);
                                                   return t;
                                                 },
                                                 {}},
                                                merged);
  EXPECT_EQ(chain.vertices.size(), 8u);
  EXPECT_TRUE(check(chain).closed_manifold());
  EXPECT_EQ(check(chain).euler, 4);
}

TEST(SurfaceChain, UndoesMergesThatGlueAlongAnEdge) {
  // Two tetrahedra that share the edge 0-1 while vertex 0 is merged, and separate (crossing points 0-8, 0-9) once it is
  // not.
  std::vector<std::uint8_t> merged(10, 1);
  int calls = 0;
  const SurfaceChain chain = make_surface_chain(
      {[&](const ChainSource::Flags& m, const ChainSource::Flags&) {
         ++calls;
         std::vector<ChainTriangle> all;
         for (const std::uint32_t side : {0u, 1u}) {
           const ChainVertex a = m[0] ? v(0) : ChainVertex{0, 8 + side}, b = m[1] ? v(1) : ChainVertex{1, 8 + side};
           const ChainVertex c = v(2 + 2 * side), d = v(3 + 2 * side);
           for (const ChainTriangle& t :
                {ChainTriangle{a, b, c}, ChainTriangle{a, d, b}, ChainTriangle{b, d, c}, ChainTriangle{a, c, d}})
             all.push_back(t);
         }
         return all;
       },
       {}},
      merged);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(chain.rounds, 2);
  EXPECT_FALSE(merged[0]);
  EXPECT_TRUE(check(chain).closed_manifold());
}

/// A row of pairs of tetrahedra that are glued along an edge while its vertices are merged: pair i is a block and
/// shares its last lattice vertex with the next one.
struct Row {
  std::uint32_t pairs;
  std::vector<std::size_t> marched = {};

  std::array<std::uint32_t, 9> lattice(std::uint32_t i) const {
    std::array<std::uint32_t, 9> v{};
    for (std::uint32_t k = 0; k < 9; ++k) v[k] = 8 * i + k;
    return v;
  }

  std::vector<ChainTriangle> march(const ChainSource::Flags& merged, const ChainSource::Flags& near) {
    std::vector<ChainTriangle> all;
    for (std::uint32_t i = 0; i < pairs; ++i) {
      const auto n = lattice(i);
      if (!near.empty() && std::none_of(n.begin(), n.end(), [&](std::uint32_t p) { return near[p] != 0; })) continue;
      for (const std::uint32_t side : {0u, 1u}) {
        const bool glued = i % 3 == 0;
        const std::uint32_t x = n[1], y = n[2], apart = n[3 + side];
        const ChainVertex a = glued && merged[x] ? v(x) : ChainVertex{x, apart},
                          b = glued && merged[y] ? v(y) : ChainVertex{y, apart};
        const ChainVertex c = v(n[5 + side]), d = side ? v(n[8]) : v(n[0]);
        for (const ChainTriangle& t :
             {ChainTriangle{a, b, c}, ChainTriangle{a, d, b}, ChainTriangle{b, d, c}, ChainTriangle{a, c, d}})
          all.push_back(t);
      }
    }
    marched.push_back(all.size());
    return all;
  }

  void widen(ChainSource::Flags& marked) const {
    const ChainSource::Flags before = marked;
    for (std::uint32_t i = 0; i < pairs; ++i)
      for (const std::uint32_t p : lattice(i))
        if (before[p])
          for (const std::uint32_t q : lattice(i)) marked[q] = 1;
  }
};

TEST(SurfaceChain, LooksOnlyAroundWhatWasUndoneAndFindsTheSame) {
  Row row{60}, whole{60};
  ChainSource::Flags merged(60 * 8 + 1, 1), merged_too = merged;
  const auto march = [](Row& r) {
    return [&r](const ChainSource::Flags& m, const ChainSource::Flags& near) { return r.march(m, near); };
  };
  const SurfaceChain local =
      make_surface_chain({march(row), [&](ChainSource::Flags& marked) { row.widen(marked); }}, merged);
  const SurfaceChain all = make_surface_chain({march(whole), {}}, merged_too);
  EXPECT_EQ(merged, merged_too);
  EXPECT_LT(std::count(merged.begin(), merged.end(), 1), 60 * 8);
  EXPECT_EQ(local.vertices, all.vertices);
  EXPECT_EQ(local.triangles, all.triangles);
  EXPECT_TRUE(check(local).closed_manifold());
  // All, then the neighbourhood, then all.
  ASSERT_EQ(row.marched.size(), 3u);
  EXPECT_EQ(row.marched[0], row.marched[2]);
  EXPECT_GT(row.marched[1], 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
