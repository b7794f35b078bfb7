#include "sansmesh/mesh/repair/components.h"

#include <gtest/gtest.h>

#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

/// Appends a tetrahedron with edges of about `size` at (x, 0, 0).
void add_tetrahedron(TriangleMesh& mesh, float x, float size) {
  const auto o = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}}) {
    mesh.vertices.push_back(p * size + Vec3f{x, 0, 0});
    mesh.colors.push_back({static_cast<std::uint8_t>(x), 0, 0});
  }
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{0, 3, 2}})
    mesh.triangles.push_back({o + t[0], o + t[1], o + t[2]});
}

TEST(Components, AreRankedByArea) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, 0, 1);
  add_tetrahedron(mesh, 5, 3);
  add_tetrahedron(mesh, 20, 2);
  const MeshComponents c = find_components(mesh);
  ASSERT_EQ(c.size(), 3u);
  EXPECT_GT(c.area[0], c.area[1]);
  EXPECT_GT(c.area[1], c.area[2]);
  EXPECT_EQ(c.of_triangle[0], 2u);
  EXPECT_EQ(c.of_triangle[4], 0u);
  EXPECT_EQ(c.of_triangle[8], 1u);
}

TEST(Components, KeepingSomeTrianglesKeepsTheirVerticesAndAttributes) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, 0, 1);
  add_tetrahedron(mesh, 5, 3);
  std::vector<std::uint8_t> keep(8, 0);
  for (std::size_t i = 4; i < 8; ++i) keep[i] = 1;
  keep_triangles(mesh, keep);
  ASSERT_EQ(mesh.vertices.size(), 4u);
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(mesh.colors[0][0], 5);
  EXPECT_TRUE(test::topology_of(mesh).closed_manifold());
}

TEST(Components, SplitTakesEverythingAlongAndLeavesUnusedVertices) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, 0, 1);
  mesh.vertices.push_back({9, 9, 9});  // unused
  mesh.colors.push_back({99, 0, 0});
  add_tetrahedron(mesh, 5, 3);
  mesh.origin = {1e6, 0, 0};
  std::vector<std::int32_t> number(mesh.triangles.size()), of_vertex(mesh.vertices.size());
  for (std::size_t i = 0; i < number.size(); ++i) number[i] = static_cast<std::int32_t>(i);
  for (std::size_t v = 0; v < of_vertex.size(); ++v) of_vertex[v] = static_cast<std::int32_t>(v);
  mesh.triangle_attributes.set("number", number);
  mesh.attributes.set("vertex", of_vertex);
  const std::vector<TriangleMesh> parts = split_components(mesh, find_components(mesh));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].vertices.size(), 4u);  // the larger one first
  EXPECT_EQ(parts[0].origin, mesh.origin);
  EXPECT_EQ(parts[0].colors[0][0], 5);
  EXPECT_EQ(*parts[0].triangle_attributes.find<std::int32_t>("number"), (std::vector<std::int32_t>{4, 5, 6, 7}));
  EXPECT_EQ(*parts[0].attributes.find<std::int32_t>("vertex"), (std::vector<std::int32_t>{5, 6, 7, 8}));
  EXPECT_EQ(parts[1].vertices.size(), 4u);
  for (const TriangleMesh& part : parts) EXPECT_TRUE(test::topology_of(part).closed_manifold());
}

TEST(Components, FansThatMeetInAVertexAreSeparated) {
  TriangleMesh mesh;
  add_tetrahedron(mesh, 0, 1);
  add_tetrahedron(mesh, 5, 3);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t)
      if (v == 4) v = 0;  // merges two vertices
  ASSERT_EQ(test::topology_of(mesh).bad_vertices, 1u);
  separate_fans(mesh);
  EXPECT_TRUE(test::topology_of(mesh).closed_manifold());
  EXPECT_EQ(find_components(mesh).size(), 2u);
}

}  // namespace
}  // namespace sansmesh::inline v1
