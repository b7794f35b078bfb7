#include "sansmesh/polygonize/polygonize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/components.h"
#include "support/any_threads.h"
#include "support/formula_field.h"
#include "support/mesh_checks.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using test::FormulaField;

const Box3 kUnitCube = test::cube_around_origin(1);

const FormulaField kSphere([](const Vec3& x) { return norm(x) - 0.61; }, kUnitCube);
const FormulaField kTorus([](const Vec3& x) { return std::hypot(std::hypot(x.x, x.y) - 0.6, x.z) - 0.23; }, kUnitCube);
const FormulaField kTwo(
    [](const Vec3& x) {
      return std::min(norm(x - Vec3{0.4, 0, 0}) - 0.3, norm(x + Vec3{0.4, 0.1, 0}) - 0.25);
    },
    kUnitCube);
const FormulaField kBox(
    [](const Vec3& x) {
      return std::max({std::abs(x.x) - 0.57, std::abs(x.y) - 0.43, std::abs(x.z) - 0.31});
    },
    kUnitCube);
/// Many handles: the hardest topology for a coarse lattice.
const FormulaField kGyroid(
    [](const Vec3& x) {
      const Vec3 p = x * 9.0;
      const double g = std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) + std::sin(p.z) * std::cos(p.x);
      return std::max(std::abs(g) / 9 - 0.04, norm(x) - 0.85);
    },
    kUnitCube);

BlockTree uniform_tree(int level) {
  BlockTree tree({-1, -1, -1}, 2);
  for (std::size_t b = 0; b < tree.size(); ++b)
    if (tree[b].level < level) tree.subdivide(b);
  return tree;
}

BlockTree random_tree(unsigned seed, int least, int most) {
  std::mt19937 generator(seed);
  BlockTree tree({-1, -1, -1}, 2);
  for (std::size_t b = 0; b < tree.size(); ++b)
    if (tree[b].level < least || (tree[b].level < most && generator() % 3 == 0)) tree.subdivide(b);
  return tree;
}

TriangleMesh extract(const ScalarField& field, const BlockTree& tree, const PolygonizeOptions& options = {}) {
  Progress progress;
  return polygonize(field, tree, {}, options, progress);
}

TEST(Polygonize, MeshesAreClosedManifoldsOfTheRightGenusOnAnyTree) {
  SANSMESH_NOT_SANITIZED("others mesh trees, too");
  for (const bool cluster : {true, false}) {
    PolygonizeOptions options;
    options.cluster = cluster;
    for (unsigned seed = 0; seed < 4; ++seed) {
      const BlockTree tree = seed == 0 ? uniform_tree(4) : random_tree(seed, 4, 6);
      for (const auto& [field, euler] :
           {std::pair<const FormulaField*, long>{&kSphere, 2}, {&kTorus, 0}, {&kTwo, 4}, {&kBox, 2}}) {
        const test::Topology t = test::topology_of(extract(*field, tree, options));
        EXPECT_TRUE(t.closed_manifold()) << "cluster " << cluster << " seed " << seed;
        EXPECT_EQ(t.euler, euler) << "cluster " << cluster << " seed " << seed;
      }
    }
  }
}

TEST(Polygonize, StaysAClosedManifoldWhereTheLatticeIsTooCoarseForTheShape) {
  SANSMESH_NOT_SANITIZED("others mesh trees, too");
  for (int level = 2; level <= 4; ++level)
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const TriangleMesh mesh = extract(kGyroid, random_tree(seed, level, level + 2));
      ASSERT_FALSE(mesh.triangles.empty());
      EXPECT_TRUE(test::topology_of(mesh).closed_manifold()) << "level " << level << " seed " << seed;
    }
}

TEST(Polygonize, IsClosedWhereTheSurfaceLeavesTheCube) {
  const FormulaField slab([](const Vec3& x) { return x.z - 0.13 * std::sin(3 * x.x); },
                          kUnitCube);  // everything below a wavy sheet
  for (const bool cluster : {false, true}) {
    PolygonizeOptions options;
    options.cluster = cluster;
    Progress progress;
    const TriangleMesh mesh = polygonize(slab, uniform_tree(4), {}, options, progress);
    const auto topology = test::topology_of(mesh);
    EXPECT_TRUE(topology.closed_manifold());
    EXPECT_EQ(topology.euler, 2);
    const Box3f box = sansmesh::bounds(mesh);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(box.lower[k], -1.001f);
      EXPECT_LE(box.upper[k], 1.001f);
      EXPECT_LT(box.lower[k], -0.9f);
    }
  }
}

TEST(Polygonize, VerticesLieOnTheSurfaceAndNormalsPointOutward) {
  PolygonizeOptions on_surface;
  on_surface.balance = false;
  const TriangleMesh mesh = extract(kTorus, random_tree(1, 4, 5), on_surface);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 p(mesh.vertices[v]);
    double f = 0;
    Vec3 g;
    kTorus.evaluate(std::span<const Vec3>(&p, 1), std::span<double>(&f, 1), std::span<Vec3>(&g, 1));
    EXPECT_LT(std::abs(f), 2e-3);
    EXPECT_GT(dot(Vec3(mesh.normals[v]), normalized(g)), 0.99);
  }
  double volume = 0;
  for (const Triangle& t : mesh.triangles)
    volume += dot(Vec3(mesh.vertices[t[0]]), cross(Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]))) / 6;
  EXPECT_NEAR(volume, 2 * M_PI * M_PI * 0.6 * 0.23 * 0.23, 0.02 * volume);
}

TEST(Polygonize, BalancedTrianglesStraddleTheSurface) {
  PolygonizeOptions on_surface;
  on_surface.balance = false;
  const auto mean_gap = [](const TriangleMesh& mesh) {
    double sum = 0, area = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
      const double s = norm(cross(b - a, c - a));
      for (const Vec3& p :
           {(a + b + c) / 3.0, (4.0 * a + b + c) / 6.0, (a + 4.0 * b + c) / 6.0, (a + b + 4.0 * c) / 6.0})
        sum += s * std::abs(norm(p) - 0.61);
      area += 4 * s;
    }
    return sum / area;
  };
  EXPECT_LT(mean_gap(extract(kSphere, uniform_tree(3))), 0.5 * mean_gap(extract(kSphere, uniform_tree(3), on_surface)));
}

double mean_aspect(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    const double x = norm(b - a), y = norm(c - b), z = norm(a - c), area = 0.5 * norm(cross(b - a, c - a));
    sum += std::min(1e3, std::max({x, y, z}) * (x + y + z) / (4 * std::sqrt(3.0) * area));
  }
  return sum / static_cast<double>(mesh.triangles.size());
}

TEST(Polygonize, ClusteringMakesFewerAndBetterTriangles) {
  PolygonizeOptions plain;
  plain.cluster = false;
  plain.smoothing_rounds = 0;
  const TriangleMesh before = extract(kTorus, uniform_tree(4), plain), after = extract(kTorus, uniform_tree(4));
  EXPECT_LT(3 * after.triangles.size(), before.triangles.size());
  EXPECT_LT(mean_aspect(after), 1.7);
}

TEST(Polygonize, DisplacementOfTheLatticeImprovesTheAspectRatio) {
  PolygonizeOptions plain;
  plain.cluster = false;
  plain.smoothing_rounds = 0;
  plain.creases = false;
  PolygonizeOptions moved = plain;
  moved.displacement = 0.95;
  const TriangleMesh before = extract(kTorus, uniform_tree(4), plain), after = extract(kTorus, uniform_tree(4), moved);
  EXPECT_TRUE(test::topology_of(after).closed_manifold());
  EXPECT_EQ(test::topology_of(after).euler, 0);
  EXPECT_LT(mean_aspect(after), 0.7 * mean_aspect(before));
  moved.displacement = 1.5;
  EXPECT_THROW(extract(kTorus, uniform_tree(3), moved), ArgumentError);
}

TEST(Polygonize, CreasesAreMet) {
  PolygonizeOptions without;
  without.creases = false;
  const auto edge_gap = [](const TriangleMesh& mesh) {
    // Distance of the nearest vertices to points along one edge of the box.
    double sum = 0;
    for (int i = 0; i < 50; ++i) {
      const Vec3f p{0.57f, 0.43f, -0.3f + 0.012f * static_cast<float>(i)};
      float best = 1e9f;
      for (const Vec3f& v : mesh.vertices)
        best = std::min(best, std::hypot(v.x - p.x, v.y - p.y) + 1e3f * (std::abs(v.z - p.z) > 0.06f));
      sum += best;
    }
    return sum / 50;
  };
  EXPECT_LT(edge_gap(extract(kBox, uniform_tree(5))), 0.002);
  EXPECT_GT(edge_gap(extract(kBox, uniform_tree(5), without)), 0.003);
}

TEST(Polygonize, FollowsOnlyTheSheetsThatSeedsLeadTo) {
  PolygonizeOptions options;
  options.seeds = {{0.7, 0, 0}};
  const TriangleMesh one = extract(kTwo, uniform_tree(4), options);
  EXPECT_TRUE(test::topology_of(one).closed_manifold());
  EXPECT_EQ(find_components(one).size(), 1u);
  EXPECT_EQ(find_components(extract(kTwo, uniform_tree(4))).size(), 2u);
}

TEST(Polygonize, IsTheSameForAnyNumberOfThreads) {
  const BlockTree tree = random_tree(2, 4, 6);
  test::compare_threads([&] { return extract(kGyroid, tree); },
                        [](const TriangleMesh& one, const TriangleMesh& many) {
                          EXPECT_EQ(one.triangles, many.triangles);
                          EXPECT_EQ(one.vertices, many.vertices);
                          EXPECT_EQ(one.normals, many.normals);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
