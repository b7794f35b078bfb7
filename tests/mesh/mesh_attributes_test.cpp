// Attributes follow the vertices and triangles of a mesh in every operation.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/progress.h"
#include "support/mesh_checks.h"

namespace sansmesh::inline v1 {
namespace {

double linear(const Vec3f& v) {
  return 3 * static_cast<double>(v.x) - 2 * static_cast<double>(v.y) + static_cast<double>(v.z) + 7;
}

/// Flat square of n × n × 2 unit triangles, with a linear function of the position (alone, and as the second of two
/// components), vertex numbers and triangle numbers.
TriangleMesh square(std::uint32_t n) {
  TriangleMesh mesh;
  std::vector<float> value;
  std::vector<double> pair;
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x) {
      mesh.vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0});
      value.push_back(static_cast<float>(linear(mesh.vertices.back())));
      pair.push_back(-5);
      pair.push_back(linear(mesh.vertices.back()));
    }
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  std::vector<std::uint32_t> number(mesh.vertices.size());
  std::iota(number.begin(), number.end(), 0u);
  std::vector<std::int16_t> triangle(mesh.triangles.size());
  std::iota(triangle.begin(), triangle.end(), std::int16_t{0});
  mesh.attributes.set("linear", value);
  mesh.attributes.set("pair", pair, 2);
  mesh.attributes.set("number", number);
  mesh.triangle_attributes.set("triangle", triangle);
  return mesh;
}

/// Invariants of every operation on that square: linear functions stay linear, numbers are those of nearby vertices,
/// triangles are inside their original ones.
void expect_followed(const TriangleMesh& mesh, const TriangleMesh& before, double tolerance, float nearest) {
  ASSERT_NO_THROW(mesh.attributes.check_rows(mesh.vertices.size(), "vertices"));
  ASSERT_NO_THROW(mesh.triangle_attributes.check_rows(mesh.triangles.size(), "triangles"));
  const auto& value = *mesh.attributes.find<float>("linear");
  const auto& pair = *mesh.attributes.find<double>("pair");
  const auto& number = *mesh.attributes.find<std::uint32_t>("number");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    ASSERT_NEAR(static_cast<double>(value[v]), linear(mesh.vertices[v]), tolerance);
    ASSERT_NEAR(pair[2 * v], -5, 1e-12);
    ASSERT_NEAR(pair[2 * v + 1], linear(mesh.vertices[v]), tolerance);
    ASSERT_LE(norm(before.vertices[number[v]] - mesh.vertices[v]), nearest);
  }
  EXPECT_EQ(mesh.triangle_attributes[0].type(), NumberType::i16);
}

void expect_parts(const TriangleMesh& mesh, const TriangleMesh& before) {
  const auto& triangle = *mesh.triangle_attributes.find<std::int16_t>("triangle");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Box3f part, whole;
    for (const std::uint32_t v : mesh.triangles[i]) part.extend(mesh.vertices[v]);
    for (const std::uint32_t v : before.triangles[static_cast<std::size_t>(triangle[i])])
      for (const float margin : {-1e-5f, 1e-5f}) whole.extend(before.vertices[v] + Vec3f{margin, margin, margin});
    ASSERT_TRUE(whole.contains(part.lower) && whole.contains(part.upper));
  }
}

TEST(MeshAttributes, FollowClipping) {
  const TriangleMesh before = square(12);
  TriangleMesh mesh = before;
  clip_mesh(mesh, {{1.3f, 0.2f, -1}, {9.8f, 7.45f, 1}});
  ASSERT_GT(mesh.triangles.size(), 100u);
  expect_followed(mesh, before, 1e-4, 1.5f);
  expect_parts(mesh, before);
}

TEST(MeshAttributes, FollowRefinement) {
  const TriangleMesh before = square(5);
  TriangleMesh mesh = before;
  ASSERT_TRUE(refine_edges(mesh, 0.3));
  ASSERT_GT(mesh.triangles.size(), 500u);
  expect_followed(mesh, before, 1e-5, 1.5f);
  expect_parts(mesh, before);
}

TEST(MeshAttributes, FollowTheTrianglesThatAreKept) {
  const TriangleMesh before = square(9);
  TriangleMesh mesh = before;
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = i % 7 == 2;
  keep_triangles(mesh, keep);
  separate_fans(mesh);
  ASSERT_EQ(mesh.triangles.size(), 23u);
  expect_followed(mesh, before, 0, 0);
  expect_parts(mesh, before);
  const auto& triangle = *mesh.triangle_attributes.find<std::int16_t>("triangle");
  for (std::size_t i = 0; i < triangle.size(); ++i) EXPECT_EQ(triangle[i], static_cast<std::int16_t>(7 * i + 2));
}

TEST(MeshAttributes, FollowFansThatAreCutApart) {
  // Two triangles with one common corner.
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  mesh.attributes.set("id", std::vector<std::int64_t>{10, 11, 12, 13, 14});
  separate_fans(mesh);
  ASSERT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(*mesh.attributes.find<std::int64_t>("id"), (std::vector<std::int64_t>{10, 11, 12, 13, 14, 10}));
}

TEST(MeshAttributes, FollowSimplification) {
  const TriangleMesh before = square(40);
  for (const int threads : {1, 2}) {
    const ThreadScope scope(threads);
    TriangleMesh mesh = before;
    Progress progress;
    ASSERT_TRUE(simplify_mesh(mesh, {.error = 1e-3, .triangles = 900}, progress));
    ASSERT_LT(mesh.triangles.size(), before.triangles.size() / 2);
    // On a flat mesh, a merged vertex is at the area-weighted mean of the merged ones.
    expect_followed(mesh, before, 1e-3, 6);
    const auto& triangle = *mesh.triangle_attributes.find<std::int16_t>("triangle");
    EXPECT_TRUE(std::is_sorted(triangle.begin(), triangle.end()));
    EXPECT_EQ(std::adjacent_find(triangle.begin(), triangle.end()), triangle.end());
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
