#include "sansmesh/mesh/edit/arrows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(Arrows, AreAPrismAndAPyramidAlongTheVector) {
  for (const int sides : {3, 8}) {
    const Vec3 at{1e6, 2, -3}, along{1, -2, 2};
    const TriangleMesh mesh = arrows(
        std::vector<Vec3>{at}, std::vector<Vec3>{along},
        {.length = {}, .scale = 2, .shaft_radius = 0.05, .head_radius = 0.1, .head_length = 0.25, .sides = sides});
    const auto n = static_cast<std::size_t>(sides);
    EXPECT_EQ(mesh.vertices.size(), 3 * n + 1);
    EXPECT_EQ(mesh.triangles.size(), 6 * n - 2);
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_TRUE(topology.closed());
    EXPECT_EQ(topology.genus(), 0);
    // Length 6.
    const double of_radius = 0.5 * sides * std::sin(2 * std::numbers::pi / sides);
    const double shaft = of_radius * 0.3 * 0.3 * 4.5, head = of_radius * 0.6 * 0.6 * 1.5 / 3;
    EXPECT_NEAR(measure_size(mesh).volume, shaft + head, 1e-5);
    const Vec3 tip = mesh.origin + Vec3(mesh.vertices.back());
    EXPECT_NEAR(norm(tip - (at + 2.0 * along)), 0, 1e-6);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_NEAR(norm(mesh.normals[v]), 1, 1e-6);
  }
}

TEST(Arrows, HaveTheLengthsAndRowsThatTheyAreGiven) {
  const std::vector<Vec3> at = {{0, 0, 0}, {5, 0, 0}, {0, 5, 0}, {0, 0, 5}, {kInfinite, 0, 0}};
  const std::vector<Vec3> v = {{0, 0, -3}, {0, 0, 0}, {0.5, 0, 0}, {0, kInfinite, 0}, {1, 0, 0}};
  AttributeTable table;
  table.set("speed", std::vector<float>{3, 0, 0.5f, 1, 1});
  const TriangleMesh scaled = arrows(at, v, {.scale = 2}, table), even = arrows(at, v, {.length = 0.25});
  const std::size_t each = 25;
  ASSERT_EQ(scaled.vertices.size(), 2 * each);
  ASSERT_EQ(even.vertices.size(), 2 * each);
  EXPECT_TRUE(measure_topology(scaled).closed());
  EXPECT_EQ(measure_topology(scaled).components, 2u);
  const auto tip = [&](const TriangleMesh& mesh, std::size_t k) {
    return mesh.origin + Vec3(mesh.vertices[(k + 1) * each - 1]);
  };
  EXPECT_NEAR(norm(tip(scaled, 0) - Vec3{0, 0, -6}), 0, 1e-6);
  EXPECT_NEAR(norm(tip(scaled, 1) - Vec3{1, 5, 0}), 0, 1e-6);
  EXPECT_NEAR(norm(tip(even, 0) - Vec3{0, 0, -0.25}), 0, 1e-6);
  EXPECT_NEAR(norm(tip(even, 1) - Vec3{0.25, 5, 0}), 0, 1e-6);
  const std::vector<float>& speed = *scaled.attributes.find<float>("speed");
  EXPECT_EQ(std::count(speed.begin(), speed.begin() + each, 3.0f), 25);
  EXPECT_EQ(std::count(speed.begin() + each, speed.end(), 0.5f), 25);
  EXPECT_TRUE(arrows({}, {}).triangles.empty());
}

TEST(Arrows, RefuseBadInput) {
  const std::vector<Vec3> one(1, Vec3{1, 0, 0});
  EXPECT_THROW(arrows(one, {}), ArgumentError);
  EXPECT_THROW(arrows(one, one, {.length = -1}), ArgumentError);
  EXPECT_THROW(arrows(one, one, {.shaft_radius = 0.1, .head_radius = 0.1}), ArgumentError);
  EXPECT_THROW(arrows(one, one, {.head_length = 1}), ArgumentError);
  EXPECT_THROW(arrows(one, one, {.sides = 2}), ArgumentError);
  AttributeTable rows;
  rows.set("a", std::vector<float>{1, 2});
  EXPECT_THROW(arrows(one, one, {}, rows), ArgumentError);
}

TEST(SpreadVertices, AreNoNearerThanTheSpacingAndLeaveNoGaps) {
  TriangleMesh mesh = test::torus_mesh(60, 120);
  const auto used = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({100, 0, 0});  // unused
  const double spacing = 0.2;
  const std::vector<std::uint32_t> chosen = spread_vertices(mesh, spacing);
  ASSERT_GT(chosen.size(), 50u);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  const auto distance = [&](std::uint32_t a, std::uint32_t b) {
    return norm(Vec3(mesh.vertices[a]) - Vec3(mesh.vertices[b]));
  };
  for (std::size_t i = 0; i < chosen.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(distance(chosen[i], chosen[j]), spacing);
  for (std::uint32_t v = 0; v < used; ++v)
    EXPECT_TRUE(
        std::any_of(chosen.begin(), chosen.end(), [&](std::uint32_t c) { return c == v || distance(c, v) < spacing; }));
  EXPECT_LT(chosen.back(), used);
  EXPECT_THROW(spread_vertices(mesh, 0), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
