#include "sansmesh/polygonize/surface_chain.h"

#include <gtest/gtest.h>

#include "support/mesh_checks.h"

namespace sansmesh {
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
  const SurfaceChain chain = make_surface_chain(
      [](const std::vector<std::uint8_t>&) {
        auto t = tetrahedron(0, 1, 2, 3);
        t.push_back({v(4), v(5), v(6)});
        t.push_back({v(5), v(4), v(6)});
        return t;
      },
      merged);
  EXPECT_EQ(chain.triangles.size(), 4u);
  EXPECT_EQ(chain.vertices.size(), 4u);
  EXPECT_TRUE(check(chain).closed_manifold());
}

TEST(SurfaceChain, SeparatesSheetsThatTouchInAVertex) {
  std::vector<std::uint8_t> merged(8, 1);
  const SurfaceChain chain = make_surface_chain(
      [](const std::vector<std::uint8_t>&) {
        auto t = tetrahedron(0, 1, 2, 3);
        for (const auto& s : tetrahedron(0, 4, 5, 6)) t.push_back(s);
        return t;
      },
      merged);
  EXPECT_EQ(chain.vertices.size(), 8u);
  EXPECT_TRUE(check(chain).closed_manifold());
  EXPECT_EQ(check(chain).euler, 4);
}

TEST(SurfaceChain, UndoesMergesThatGlueAlongAnEdge) {
  // Two tetrahedra that share the edge 0-1 as long as vertex 0 is merged; apart (crossing points 0-8, 0-9) once it is
  // not.
  std::vector<std::uint8_t> merged(10, 1);
  int calls = 0;
  const SurfaceChain chain = make_surface_chain(
      [&](const std::vector<std::uint8_t>& m) {
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
      merged);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(chain.rounds, 2);
  EXPECT_FALSE(merged[0]);
  EXPECT_TRUE(check(chain).closed_manifold());
}

}  // namespace
}  // namespace sansmesh
