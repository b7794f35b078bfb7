#include "sansmesh/render/scene/corner_normals.h"

#include <gtest/gtest.h>

#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2)});
  const std::uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) {
    mesh.triangles.push_back({s[0], s[1], s[2]});
    mesh.triangles.push_back({s[0], s[2], s[3]});
  }
  return mesh;
}

Vec3f face_normal(const TriangleMesh& mesh, const Triangle& t) {
  return normalized(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]));
}

TEST(CornerNormals, FollowASphere) {
  const TriangleMesh mesh = test::octasphere(4);
  const std::vector<Vec3f> normals = corner_normals(mesh);
  ASSERT_EQ(normals.size(), 3 * mesh.triangles.size());
  for (std::size_t i = 0; i < normals.size(); ++i)
    EXPECT_GT(dot(normals[i], mesh.vertices[mesh.triangles[i / 3][i % 3]]), 0.999f);
}

TEST(CornerNormals, KeepTheEdgesOfACube) {
  TriangleMesh mesh = cube();
  // Vertex normals along the diagonals must not round the edges.
  for (const bool given : {false, true}) {
    if (given)
      for (const Vec3f& v : mesh.vertices) mesh.normals.push_back(normalized(v - Vec3f{0.5f, 0.5f, 0.5f}));
    const std::vector<Vec3f> normals = corner_normals(mesh);
    for (std::size_t i = 0; i < normals.size(); ++i)
      EXPECT_LT(norm(normals[i] - face_normal(mesh, mesh.triangles[i / 3])), 1e-6f);
  }
}

TEST(CornerNormals, SurviveWorthlessInput) {
  TriangleMesh mesh = cube();
  mesh.triangles.push_back({0, 0, 1});  // without area
  mesh.normals.assign(mesh.vertices.size(), Vec3f{std::nanf(""), 0, 0});
  const std::vector<Vec3f> normals = corner_normals(mesh);
  for (std::size_t i = 0; i < normals.size() - 3; ++i) EXPECT_NEAR(norm(normals[i]), 1, 1e-5);
  EXPECT_EQ(normals.back(), Vec3f{});

  // A fan with so many blades that comparing all pairs would take minutes.
  TriangleMesh fan;
  fan.vertices.push_back({0, 0, 0});
  const std::uint32_t blades = 300000;
  for (std::uint32_t i = 0; i < blades; ++i) {
    const double angle = 2 * std::numbers::pi * i / blades;
    fan.vertices.push_back(Vec3f(Vec3{std::cos(angle), std::sin(angle), 0}));
    fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % blades});
  }
  for (const Vec3f& n : corner_normals(fan)) ASSERT_GT(n.z, 0.99f);
}

}  // namespace
}  // namespace sansmesh::inline v1
