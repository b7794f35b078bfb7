#include "sansmesh/mesh/repair/self_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>

namespace sansmesh::inline v1 {
namespace {

TriangleMesh tetrahedra(const std::vector<Vec3f>& at, float size) {
  TriangleMesh mesh;
  for (const Vec3f& p : at) {
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3f& d : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}})
      mesh.vertices.push_back(p + d * size);
    for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}})
      mesh.triangles.push_back({n + t[0], n + t[1], n + t[2]});
  }
  return mesh;
}

TEST(SelfIntersections, FindsEdgesThroughTriangles) {
  EXPECT_TRUE(self_intersections({}, 0).empty());
  EXPECT_TRUE(self_intersections(tetrahedra({{0, 0, 0}}, 1), 0).empty());
  // A row of many, two of which overlap.
  std::vector<Vec3f> row;
  for (int i = 0; i < 200; ++i) row.push_back({1.1f * static_cast<float>(i), 0, 0});
  EXPECT_TRUE(self_intersections(tetrahedra(row, 1), 0).empty());
  row[120].x -= 0.2f;
  row[120].y += 0.05f;
  row[120].z += 0.05f;
  const auto found = self_intersections(tetrahedra(row, 1), 0);
  ASSERT_FALSE(found.empty());
  for (const auto& [a, b] : found) {
    EXPECT_EQ(a / 4, 119u);
    EXPECT_EQ(b / 4, 120u);
  }
  // Same, by counting only.
  std::vector<std::array<std::uint32_t, 2>> seen;
  std::mutex mutex;
  const std::size_t count = count_self_intersections(tetrahedra(row, 1), 0, [&](std::uint32_t a, std::uint32_t b) {
    const std::lock_guard lock(mutex);
    seen.push_back({a, b});
  });
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(count, found.size());
  EXPECT_EQ(seen, found);
  // Smaller than the tolerance.
  EXPECT_TRUE(self_intersections(tetrahedra(row, 1), 0.3).empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
