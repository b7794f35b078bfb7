#include "sansmesh/mesh/mesh_size.h"

#include <gtest/gtest.h>

#include <limits>

#include "sansmesh/mesh/repair/components.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

TEST(MeshSize, OfATetrahedronAnywhere) {
  for (const Vec3f& at : {Vec3f{}, Vec3f{1024, -512, 256}}) {
    TriangleMesh mesh;
    mesh.vertices = {at, at + Vec3f{2, 0, 0}, at + Vec3f{0, 3, 0}, at + Vec3f{0, 0, 4}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const MeshSize size = measure_size(mesh);
    // Three right triangles, and the oblique one by de Gua's theorem.
    EXPECT_DOUBLE_EQ(size.area, 3 + 4 + 6 + std::sqrt(9.0 + 16 + 36));
    EXPECT_DOUBLE_EQ(size.volume, 4);
    for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
    EXPECT_DOUBLE_EQ(measure_size(mesh).volume, -4);
  }
}

TEST(MeshSize, IsTheSumOverComponents) {
  TriangleMesh mesh = test::octasphere(3);
  const MeshSize one = measure_size(mesh);
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::size_t triangles = mesh.triangles.size();
  for (std::size_t v = 0; v < n; ++v) mesh.vertices.push_back(2.0f * mesh.vertices[v] + Vec3f{8, 0, 0});
  for (std::size_t t = 0; t < triangles; ++t) {
    const Triangle& a = mesh.triangles[t];
    mesh.triangles.push_back({a[0] + n, a[1] + n, a[2] + n});
  }
  const MeshSize both = measure_size(mesh);
  EXPECT_NEAR(both.area, 5 * one.area, 1e-5 * one.area);
  EXPECT_NEAR(both.volume, 9 * one.volume, 1e-5 * one.volume);
  const MeshComponents parts = find_components(mesh);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(parts.area[0] + parts.area[1], both.area, 1e-12 * both.area);
}

TEST(MeshSize, LeavesOutWhatHasNoArea) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 9}};
  EXPECT_DOUBLE_EQ(measure_size(mesh).area, 0.5);
  EXPECT_EQ(measure_size({}).area, 0);
}

}  // namespace
}  // namespace sansmesh::inline v1
