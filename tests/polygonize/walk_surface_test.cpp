#include "sansmesh/polygonize/lattice/walk_surface.h"
#include "sansmesh/mesh_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/search/kd_tree.h"
#include "support/any_threads.h"
#include "support/formula_field.h"
#include "support/mesh_checks.h"
#include "support/same_bytes.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

using test::FormulaField;

const Box3 kFormulaCube = test::cube_around_origin(1);

const FormulaField kBall([](const Vec3& x) { return norm(x - Vec3{0.013, 0.007, -0.011}) - 0.61; }, kFormulaCube);
const FormulaField kRing([](const Vec3& x) { return std::hypot(std::hypot(x.x, x.y) - 0.6, x.z - 0.003) - 0.23; },
                         kFormulaCube);
const FormulaField kPair(
    [](const Vec3& x) {
      return std::min(norm(x - Vec3{0.43, 0.01, 0.02}) - 0.31, norm(x + Vec3{0.43, 0.1, 0.03}) - 0.27);
    },
    kFormulaCube);
const FormulaField kCut([](const Vec3& x) { return norm(x - Vec3{0.9, 0.1, 0.2}) - 0.6; }, kFormulaCube);
/// Many handles and two sheets close together: lattice vertices cannot always move.
const FormulaField kShell(
    [](const Vec3& x) {
      const Vec3 p = x * 9.0;
      const double g = std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) + std::sin(p.z) * std::cos(p.x);
      return std::max(std::abs(g) / 9 - 0.04, norm(x) - 0.85);
    },
    kFormulaCube);

BlockTree even_blocks(int level) {
  BlockTree tree({-1, -1, -1}, 2);
  for (std::size_t b = 0; b < tree.size(); ++b)
    if (tree[b].level < level) tree.subdivide(b);
  return tree;
}

/// Blocks of random levels from 2 to `most`.
BlockTree uneven_blocks(unsigned seed, int most) {
  std::mt19937 random(seed);
  BlockTree tree({-1, -1, -1}, 2);
  for (std::size_t b = 0; b < tree.size(); ++b)
    if (tree[b].level < 2 || (tree[b].level < most && random() % 3 == 0)) tree.subdivide(b);
  return tree;
}

/// Points all over the cube: every sheet that is not tiny has some in its simplices.
std::vector<Vec3> many_seeds() {
  std::vector<Vec3> seeds;
  for (int z = 0; z < 30; ++z)
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 30; ++x) seeds.push_back(Vec3{x + 0.5, y + 0.5, z + 0.5} / 15.0 - Vec3{1, 1, 1});
  return seeds;
}

TriangleMesh walked_mesh(const ScalarField& field, const BlockTree& tree, double displacement = 0,
                         std::vector<Vec3> seeds = many_seeds(), WalkReport* report = nullptr) {
  Progress progress;
  return walk_surface(field, tree, {}, {displacement, std::move(seeds)}, progress, report);
}

/// Extraction from all blocks, with vertices exactly on the lattice's edges.
TriangleMesh visited_mesh(const ScalarField& field, const BlockTree& tree) {
  PolygonizeOptions options;
  options.cluster = options.creases = options.balance = false;
  options.root_steps = options.smoothing_rounds = 0;
  Progress progress;
  return polygonize(field, tree, {}, options, progress);
}

TEST(WalkSurface, FindsWhatAVisitOfAllBlocksFinds) {
  for (const FormulaField* field : {&kBall, &kRing, &kPair, &kCut})
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(seed);
      const BlockTree tree = uneven_blocks(seed, 5);
      const TriangleMesh walk = walked_mesh(*field, tree), all = visited_mesh(*field, tree);
      ASSERT_GT(walk.triangles.size(), 500u);
      EXPECT_EQ(walk.triangles.size(), all.triangles.size());
      ASSERT_EQ(walk.vertices.size(), all.vertices.size());
      // Equal positions with equal multiplicities: near lattice vertices several edges are cut at one point.
      const KdTree here(walk.vertices), there(all.vertices);
      for (const Vec3f& v : walk.vertices) {
        EXPECT_GT(there.count_within(v, 1e-5f), 0u);
        EXPECT_EQ(here.count_within(v, 1e-3f), there.count_within(v, 1e-3f));
      }
      // The cut of a simplex is planar, whichever diagonal divides it.
      const MeshQuality a = measure_quality(walk), b = measure_quality(all);
      EXPECT_NEAR(a.area, b.area, 1e-5);
      EXPECT_NEAR(a.volume, b.volume, 1e-5);
    }
}

TEST(WalkSurface, IsAClosedManifoldAlsoWhereTheSurfaceLeavesTheCubeAndWithDisplacement) {
  SANSMESH_NOT_SANITIZED("judges topology; others walk, too");
  for (const FormulaField* field : {&kBall, &kRing, &kPair, &kCut, &kShell})
    for (const double displacement : {0.0, 0.5, 0.95}) {
      const TriangleMesh mesh = walked_mesh(*field, uneven_blocks(9, 5), displacement);
      EXPECT_TRUE(test::topology_of(mesh).closed_manifold());
      EXPECT_GT(measure_quality(mesh).volume, 0);
    }
}

TEST(WalkSurface, FollowsOnlySheetsThatASeedLeadsTo) {
  const BlockTree tree = even_blocks(5);
  const Vec3 right{0.43 + 0.31, 0.01, 0.02}, left{-0.43 - 0.27, -0.1, -0.03};
  WalkReport report;
  const TriangleMesh one = walked_mesh(kPair, tree, 0, {right}, &report);
  EXPECT_EQ(find_components(one).size(), 1u);
  EXPECT_EQ(report.started, 1u);
  for (const Vec3f& v : one.vertices) EXPECT_GT(v.x, 0);
  EXPECT_EQ(find_components(walked_mesh(kPair, tree, 0, {right, left})).size(), 2u);
  EXPECT_TRUE(walked_mesh(kPair, tree, 0, {{0.43, 0, 0}, {5, 5, 5}}).triangles.empty());
}

TEST(WalkSurface, DisplacementMakesTrianglesEvenAndTurnsNone) {
  SANSMESH_NOT_SANITIZED("judges shapes; others walk, too");
  for (const FormulaField* field : {&kBall, &kRing}) {
    const BlockTree tree = even_blocks(5);
    const MeshQuality before = measure_quality(walked_mesh(*field, tree));
    WalkReport report;
    const TriangleMesh mesh = walked_mesh(*field, tree, 0.9, many_seeds(), &report);
    const MeshQuality after = measure_quality(mesh);
    // tejada2008, 4.4.4: 5.55 ± 128.09 becomes 1.68 ± 0.61.
    EXPECT_GT(before.aspect_mean, 2.5);
    EXPECT_LT(after.aspect_mean, 1.9);
    EXPECT_LT(after.aspect_deviation, 1);
    EXPECT_EQ(after.triangles, before.triangles);
    EXPECT_GT(report.moved, 100 * report.held);
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
      const Vec3f up = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
      EXPECT_GT(dot(cross(b - a, c - a), Vec3(up)), 0);
    }
  }
}

/// Where two sheets pull a vertex both ways, a move would change its sign or invert a simplex: it stays.
TEST(WalkSurface, DisplacementIsHeldWhereItWouldFold) {
  WalkReport report;
  const TriangleMesh mesh = walked_mesh(kShell, even_blocks(4), 0.99, many_seeds(), &report);
  EXPECT_GT(report.held, 0u);
  EXPECT_GT(report.moved, report.held);
  EXPECT_EQ(mesh.triangles.size(), walked_mesh(kShell, even_blocks(4)).triangles.size());
}

double aspect_of_corners(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double x = norm(b - a), y = norm(c - b), z = norm(a - c);
  return std::max({x, y, z}) * (x + y + z) / (4 * std::numbers::sqrt3 * triangle_area(a, b, c));
}

/// M_l belongs to a level: values far off the surface on a coarse level must not affect the moves of fine blocks.
TEST(WalkSurface, MovesByLevel) {
  BlockTree tree = even_blocks(3);
  for (std::size_t b = 0, n = tree.size(); b < n; ++b)
    if (tree.is_leaf(b) && tree.block_center(b).x > 0) tree.subdivide(b);
  // A plane across the levels is cut alike on both, at different scales.
  const FormulaField plane([](const Vec3& x) { return x.z - 1e-9; }, kFormulaCube);
  const TriangleMesh mesh = walked_mesh(plane, tree, 0.8);
  double sum[2] = {0, 0}, n[2] = {0, 0};
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]), m = (a + b + c) / 3.0;
    if (std::abs(m.z) > 0.1 || std::abs(m.y) > 0.75 || std::abs(m.x) < 0.25 || std::abs(m.x) > 0.75) continue;
    sum[m.x > 0] += aspect_of_corners(a, b, c), n[m.x > 0] += 1;
  }
  ASSERT_GT(n[0], 20);
  ASSERT_GT(n[1], 20);
  EXPECT_NEAR(sum[0] / n[0], sum[1] / n[1], 0.02);
}

TEST(WalkSurface, DoesNotDependOnThreads) {
  test::compare_threads([] { return walked_mesh(kRing, uneven_blocks(3, 5), 0.7); },
                        [](const TriangleMesh& a, const TriangleMesh& b) {
                          EXPECT_TRUE(test::same_bytes(a.vertices, b.vertices));
                          EXPECT_TRUE(test::same_bytes(a.triangles, b.triangles));
                        });
}

TEST(WalkSurface, RefusesDisplacementsThatWouldBreakTheLattice) {
  for (const double displacement : {-0.1, 1.0, std::nan("")})
    EXPECT_THROW(walked_mesh(kBall, even_blocks(2), displacement), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
