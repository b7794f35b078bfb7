#include "sansmesh/mesh/edit/replace_region.h"
// A region of a mesh replaced by that of another, where they differ.
// Replacement of a changed region of a mesh.

#include <algorithm>
#include <cmath>
#include <random>

#include "function/mesh_sets.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Flat lattice of n × n unit squares with heights at its vertices.
template <class Height>
TriangleMesh lattice(std::uint32_t n, Height&& height, std::uint32_t from = 0) {
  TriangleMesh mesh;
  const std::uint32_t m = n + 1;
  for (std::uint32_t y = 0; y < m; ++y)
    for (std::uint32_t x = 0; x < m; ++x) {
      const auto fx = static_cast<float>(x + from), fy = static_cast<float>(y + from);
      mesh.vertices.push_back({fx, fy, height(fx, fy)});
    }
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * m + x;
      mesh.triangles.push_back({a, a + 1, a + m});
      mesh.triangles.push_back({a + 1, a + m + 1, a + m});
    }
  return mesh;
}

float flat(float, float) { return 0; }
float hill(float x, float y) { return std::max(0.0f, 3.0f - norm(Vec3f{x - 10, y - 10, 0})); }
const std::vector<Box3f> kHill{Box3f{{6.5f, 6.5f, -1}, {13.5f, 13.5f, 4}}};
const std::vector<Box3f> kSound{Box3f{{4, 4, -9}, {16, 16, 9}}};

TEST(ReplaceRegion, TakesThePatchWhereTheyDiffer) {
  TriangleMesh mesh = lattice(20, flat);
  const TriangleMesh patch = lattice(14, hill, 3);
  const RegionReplacement r = replace_region(mesh, patch, kSound, kHill, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.agreement, 1);
  EXPECT_EQ(r.removed, r.added);
  EXPECT_GT(r.added, 20u);
  EXPECT_EQ(triangle_set(mesh), triangle_set(lattice(20, hill)));
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold() && topology.oriented());
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_EQ(topology.vertices, 21u * 21u);
  EXPECT_EQ(topology.unused_vertices, 0u);
}

TEST(ReplaceRegion, TakesNothingWhereTheyAgree) {
  TriangleMesh mesh = lattice(20, hill);
  const TriangleMesh before = mesh;
  const RegionReplacement r = replace_region(mesh, lattice(14, hill, 3), kSound, kHill, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.removed + r.added, 0u);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(ReplaceRegion, LeavesDifferencesAwayFromTheChange) {
  // The patch differs at the hill, and accidentally at a bump elsewhere.
  const auto bump = [](float x, float y) { return hill(x, y) + (x == 5 && y == 5 ? 0.5f : 0.0f); };
  TriangleMesh mesh = lattice(20, flat);
  const RegionReplacement r = replace_region(mesh, lattice(14, bump, 3), kSound, kHill, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_LT(r.agreement, 1);
  EXPECT_EQ(triangle_set(mesh), triangle_set(lattice(20, hill)));
}

TEST(ReplaceRegion, FailsWhereAPieceReachesOut) {
  const TriangleMesh before = lattice(20, flat);
  const auto ridge = [](float x, float) { return x == 10 ? 1.0f : 0.0f; };
  TriangleMesh mesh = before;
  RegionReplacement r = replace_region(mesh, lattice(14, ridge, 3), kSound, kHill, 1e-3f);
  EXPECT_FALSE(r.done);
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.vertices, before.vertices);
  // A patch of a different surface.
  r = replace_region(mesh,
                     lattice(
                         14, [](float, float) { return 0.3f; }, 3),
                     kSound, kHill, 1e-3f);
  EXPECT_EQ(r.agreement, 0);
  EXPECT_FALSE(r.done);
  r = replace_region(mesh, {}, kSound, kHill, 1e-3f);
  EXPECT_FALSE(r.done);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(ReplaceRegion, SeveralRegionsAtOnceAndThoseThatCannotBeJoinedStay) {
  // A hill, and a ridge that extends beyond its region.
  const auto height = [](float x, float y) { return x < 20 ? hill(x, y) : x == 32 ? 1.0f : 0.0f; };
  const TriangleMesh before = lattice(40, flat);
  const std::vector<Box3f> sound{kSound[0], Box3f{{26, 4, -9}, {38, 16, 9}}},
      changed{kHill[0], Box3f{{31.5f, 8, -1}, {32.5f, 12, 2}}};
  TriangleMesh mesh = before;
  const RegionReplacement r = replace_region(mesh, lattice(40, height), sound, changed, 1e-3f);
  EXPECT_FALSE(r.done);
  EXPECT_EQ(r.spoiled, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(triangle_set(mesh), triangle_set(lattice(40, hill)));
  // Two overlapping boxes, neither of which contains the whole hill.
  mesh = before;
  const std::vector<Box3f> halves{Box3f{{4, 4, -9}, {11, 16, 9}}, Box3f{{9, 4, -9}, {16, 16, 9}}};
  EXPECT_TRUE(replace_region(mesh, lattice(40, hill), halves, kHill, 1e-3f).done);
  EXPECT_EQ(triangle_set(mesh), triangle_set(lattice(40, hill)));
  // Insufficient agreement: nothing is replaced.
  mesh = before;
  const auto other = [](float x, float y) { return hill(x, y) + (x < 9 && y < 9 ? 0.5f : 0.0f); };
  const RegionReplacement poor = replace_region(mesh, lattice(40, other), kSound, kHill, 1e-3f, 0.99);
  EXPECT_LT(poor.agreement, 0.99);
  EXPECT_FALSE(poor.done);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(ReplaceRegion, WholeComponents) {
  // Two spheres, one of which disappears and then reappears.
  const TriangleMesh small = octasphere(2), both = joined(octasphere(3), small, {3, 0, 0});
  const std::vector<Box3f> around{Box3f{{1.9f, -1.1f, -1.1f}, {4.1f, 1.1f, 1.1f}}},
      sound{Box3f{{1.5f, -2, -2}, {5, 2, 2}}};
  TriangleMesh mesh = both;
  RegionReplacement r = replace_region(mesh, {}, sound, around, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.removed, small.triangles.size());
  EXPECT_EQ(triangle_set(mesh), triangle_set(octasphere(3)));
  r = replace_region(mesh, joined({}, small, {3, 0, 0}), sound, around, 1e-3f);
  EXPECT_TRUE(r.done);
  EXPECT_EQ(r.added, small.triangles.size());
  EXPECT_EQ(triangle_set(mesh), triangle_set(both));
  EXPECT_TRUE(measure_topology(mesh).closed());
}

TEST(ReplaceRegion, ToleratesRoundingButNotCoincidence) {
  // Slightly different vertices match one to one.
  TriangleMesh mesh = lattice(20, flat);
  TriangleMesh patch = lattice(14, hill, 3);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-4e-4f, 4e-4f);
  for (Vec3f& v : patch.vertices) v += Vec3f{uniform(random), uniform(random), uniform(random)};
  EXPECT_TRUE(replace_region(mesh, patch, kSound, kHill, 1e-3f).done);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold() && topology.oriented());
  EXPECT_EQ(topology.boundary_loops, 1u);

  // Triangles smaller than the tolerance: none of their vertices are merged.
  TriangleMesh fine = lattice(20, flat);
  const RegionReplacement r = replace_region(fine, patch, kSound, kHill, 1.5f);
  const MeshTopology now = measure_topology(fine);
  EXPECT_TRUE(!r.done || (now.manifold() && now.oriented() && now.degenerate_triangles == 0));
}

TEST(ReplaceRegion, AttributesComeAlong) {
  TriangleMesh mesh = lattice(20, flat), patch = lattice(14, hill, 3);
  mesh.normals.assign(mesh.vertices.size(), {0, 0, 1});
  mesh.attributes.set("quality", std::vector<float>(mesh.vertices.size(), 1));
  mesh.attributes.set("id", std::vector<std::int32_t>(mesh.vertices.size(), 5));
  mesh.triangle_attributes.set("part", std::vector<std::uint8_t>(mesh.triangles.size(), 1));
  patch.triangle_attributes.set("part", std::vector<std::uint8_t>(patch.triangles.size(), 2));
  mesh.colors.assign(mesh.vertices.size(), {1, 2, 3});
  patch.normals.assign(patch.vertices.size(), {1, 0, 0});
  patch.colors.assign(patch.vertices.size(), {9, 8, 7});  // and no vertex attributes
  ASSERT_TRUE(replace_region(mesh, patch, kSound, kHill, 1e-3f).done);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  const auto& quality = *mesh.attributes.find<float>("quality");
  const auto& id = *mesh.attributes.find<std::int32_t>("id");
  const auto& part = *mesh.triangle_attributes.find<std::uint8_t>("part");
  ASSERT_EQ(quality.size(), mesh.vertices.size());
  ASSERT_EQ(part.size(), mesh.triangles.size());
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const bool is_new = mesh.vertices[v].z > 0;
    EXPECT_EQ(mesh.normals[v], is_new ? (Vec3f{1, 0, 0}) : (Vec3f{0, 0, 1}));
    EXPECT_EQ(mesh.colors[v][0], is_new ? 9 : 1);
    EXPECT_TRUE(is_new ? std::isnan(quality[v]) : quality[v] == 1);  // unknown
    EXPECT_EQ(id[v], is_new ? 0 : 5);
  }
  for (std::size_t i = 0; i < part.size(); ++i) {
    bool is_new = false;
    for (const std::uint32_t v : mesh.triangles[i]) is_new = is_new || mesh.vertices[v].z > 0;
    EXPECT_EQ(part[i], is_new ? 2 : 1);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
