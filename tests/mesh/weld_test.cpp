#include "sansmesh/mesh/repair/weld.h"

#include <gtest/gtest.h>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

/// Unit tetrahedron whose faces have separate corners, colours and normals.
TriangleMesh soup(float shake = 0) {
  const Vec3f corner[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  TriangleMesh mesh;
  std::vector<std::int32_t> label;
  std::vector<float> value, of_face;
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{0, 3, 2}}) {
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3f normal = normalized(cross(corner[t[1]] - corner[t[0]], corner[t[2]] - corner[t[0]]));
    for (const std::uint32_t v : t) {
      mesh.vertices.push_back(corner[v] + Vec3f{shake * static_cast<float>(mesh.triangles.size()), 0, 0});
      mesh.normals.push_back(normal);
      mesh.colors.push_back({static_cast<std::uint8_t>(10 * mesh.triangles.size()), 0, 255});
      label.push_back(static_cast<std::int32_t>(mesh.triangles.size()));
      value.push_back(static_cast<float>(mesh.triangles.size()));
    }
    of_face.push_back(static_cast<float>(mesh.triangles.size()));
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  mesh.attributes.set("label", label);
  mesh.attributes.set("value", value);
  mesh.triangle_attributes.set("face", of_face);
  return mesh;
}

TEST(Weld, ASoupBecomesClosedAndItsCornersAreMeans) {
  for (const float shake : {0.0f, 1e-4f}) {
    TriangleMesh mesh = soup(shake);
    const WeldReport report = weld_vertices(mesh, 3.5 * static_cast<double>(shake));
    EXPECT_EQ(report.vertices, 8u);
    EXPECT_EQ(report.triangles, 0u);
    ASSERT_EQ(mesh.vertices.size(), 4u);
    EXPECT_TRUE(measure_topology(mesh).closed());
    EXPECT_EQ(mesh.vertices[0], (Vec3f{0, 0, 0}));
    // Corner 0 belongs to the faces 0, 1 and 3.
    EXPECT_EQ(mesh.colors[0][0], 13);
    EXPECT_FLOAT_EQ((*mesh.attributes.find<float>("value"))[0], 4.0f / 3);
    EXPECT_EQ((*mesh.attributes.find<std::int32_t>("label"))[0], 0);
    EXPECT_NEAR(norm(mesh.normals[0] + normalized(Vec3f{1, 1, 1})), 0, 1e-6);
    EXPECT_EQ(mesh.triangle_attributes.find("face")->rows(), 4u);
  }
}

TEST(Weld, SaysWhichEdgesAreNoLongerManifold) {
  // Two tetrahedra with a common edge.
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {4, 6, 5}, {4, 5, 7}, {5, 6, 7}, {4, 7, 6}};
  ASSERT_TRUE(measure_topology(mesh).closed());
  const WeldReport report = weld_vertices(mesh, 0);
  EXPECT_EQ(report.vertices, 2u);
  EXPECT_EQ(report.nonmanifold_edges, 1u);
  EXPECT_EQ(measure_topology(mesh).nonmanifold_edges, 1u);
  TriangleMesh joined = soup();
  EXPECT_EQ(weld_vertices(joined, 0).nonmanifold_edges, 0u);
}

TEST(Weld, TrianglesThatShrinkGoWithTheirAttributes) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0.01f, 0}};
  mesh.triangles = {{1, 3, 0}, {0, 3, 2}};
  mesh.triangle_attributes.set("id", std::vector<std::int32_t>{7, 8});
  mesh.normals.assign(4, Vec3f(normalized(Vec3{0.1, 0.2, 0.3})));
  const Vec3f unit = mesh.normals[0];
  const WeldReport report = weld_vertices(mesh, 0.02);
  EXPECT_EQ(report.vertices, 1u);
  EXPECT_EQ(report.triangles, 1u);
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ((*mesh.triangle_attributes.find<std::int32_t>("id"))[0], 8);
  EXPECT_EQ(mesh.normals[0], unit);  // not merged
  EXPECT_THROW(weld_vertices(mesh, -1), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
