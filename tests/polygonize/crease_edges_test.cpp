#include "sansmesh/polygonize/creases/crease_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/polygonize/polygonize.h"
#include "support/formula_field.h"
#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

using test::FormulaField;

const Box3 kCube = test::cube_around_origin(1);

/// Number of edges whose middle is farther from the surface than this.
std::size_t far_middles(const ScalarField& field, const TriangleMesh& mesh, double distance) {
  std::vector<Vec3> middles;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3])
        middles.push_back(mesh.origin + (Vec3(mesh.vertices[t[k]]) + Vec3(mesh.vertices[t[(k + 1) % 3]])) / 2);
  std::vector<double> f(middles.size());
  field.evaluate(middles, f);
  return static_cast<std::size_t>(std::ranges::count_if(f, [&](double v) { return std::abs(v) > distance; }));
}

TEST(CreaseEdges, FewEdgesOfATiltedCubesMeshBridgeItsEdges) {
  const Vec3 a = normalized(Vec3{1, 0.2, 0.3}), b = normalized(cross(a, Vec3{0.1, 0.3, 1})), c = cross(a, b);
  const FormulaField tilted(
      [&](const Vec3& x) {
        return std::max({std::abs(dot(x, a)), std::abs(dot(x, b)), std::abs(dot(x, c))}) - 0.5;
      },
      kCube);
  BlockTree tree({-1, -1, -1}, 2);
  for (std::size_t i = 0; i < tree.size(); ++i)
    if (tree[i].level < 5) tree.subdivide(i);
  PolygonizeOptions options;
  options.balance = false;
  options.creases = true;
  Progress progress;
  EXPECT_LT(far_middles(tilted, polygonize(tilted, tree, {}, options, progress), 0.05 * 2 / 32), 40u);
}

TEST(CreaseEdges, TurnsTheDiagonalOfAFoldedSquare) {
  // The fold runs from vertex 1 to 3, the edge of both triangles from 0 to 2.
  const FormulaField roof([](const Vec3& x) { return x.z + std::abs(x.x + x.y - 1); }, kCube);
  const std::vector<Vec3> x{{0, 0, -1}, {1, 0, 0}, {1, 1, -1}, {0, 1, 0}, {2, -1, 0}, {-1, 2, 0}};
  std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {1, 4, 2}, {0, 3, 5}, {3, 2, 5}};
  // Normals of the roof's faces, one on either side, and in between at its ridge.
  const Vec3f left = normalized(Vec3f{-1, -1, 1}), right = normalized(Vec3f{1, 1, 1}), up{0, 0, 1};
  const std::vector<Vec3f> normals{left, up, right, up, up, up};
  EXPECT_EQ(turn_edges_to_creases(roof, x, normals, triangles), 1u);
  for (const Triangle& t : triangles) EXPECT_FALSE(std::ranges::count(t, 0u) > 0 && std::ranges::count(t, 2u) > 0);
  EXPECT_EQ(turn_edges_to_creases(roof, x, normals, triangles), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
