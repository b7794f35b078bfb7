#include "sansmesh/meshing/narrow_handles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/handled_meshes.h"
#include "support/mesh_checks.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Spacing of torus_samples(64, 24).
constexpr double kSpacing = 0.092;

/// A torus with a bridge across its hole and a tunnel through its tube.
TriangleMesh spurious_torus() {
  const TriangleMesh bridged = test::with_prism(test::torus_mesh(96, 40), {0.65, 0, 0}, {-0.65, 0, 0});
  return test::with_prism(bridged, {0, 1, 0.35}, {0, 1, -0.35});
}

TEST(NarrowHandles, WithoutSamplesAreClosed) {
  TriangleMesh mesh = spurious_torus();
  ASSERT_EQ(measure_topology(mesh).genus(), 3);
  const NarrowHandles found = close_handles(mesh, test::torus_samples(64, 24), kSpacing, 0, true);
  EXPECT_EQ(found.closed, 2u);
  EXPECT_EQ(found.genus, 1u);
  EXPECT_EQ(found.narrow, 0u);
  const test::Topology topology = test::topology_of(mesh);
  EXPECT_TRUE(topology.closed_manifold());
  EXPECT_EQ(topology.euler, 0);
  // The caps continue the surface: every vertex is near the torus.
  for (const Vec3f& v : mesh.vertices) {
    const Vec3 x(v);
    const double ring = std::hypot(x.x, x.y) - 1;
    EXPECT_NEAR(std::hypot(ring, x.z), 0.35, 0.1 * kSpacing);
  }
}

TEST(NarrowHandles, StayOnRequestAndAreNamed) {
  TriangleMesh mesh = spurious_torus();
  const std::size_t before = mesh.triangles.size();
  const NarrowHandles found = close_handles(mesh, test::torus_samples(64, 24), kSpacing, 0, false);
  EXPECT_EQ(found.closed, 0u);
  EXPECT_EQ(found.genus, 3u);
  EXPECT_EQ(found.narrow, 2u);
  EXPECT_EQ(mesh.triangles.size(), before);
  // One of the four ends.
  const Vec3 ends[] = {{0.65, 0, 0}, {-0.65, 0, 0}, {0, 1, 0.35}, {0, 1, -0.35}};
  EXPECT_TRUE(std::any_of(std::begin(ends), std::end(ends),
                          [&](const Vec3& end) { return norm(found.narrowest - end) < kSpacing; }));
}

TEST(NarrowHandles, StayWithoutNormalsOrSamples) {
  PointSet points = test::torus_samples(64, 24);
  points.normals.clear();
  for (const PointSet& samples : {points, PointSet{}}) {
    TriangleMesh mesh = spurious_torus();
    const NarrowHandles found = close_handles(mesh, samples, kSpacing, 0, true);
    EXPECT_EQ(found.closed, 0u);
    EXPECT_EQ(found.genus, 3u);
    EXPECT_EQ(found.narrow, 2u);
  }
}

TEST(NarrowHandles, WithSamplesStay) {
  // Tubes of 3, 2 and 1.6 spacings.
  for (const std::uint32_t around : {10u, 6u, 5u}) {
    const std::uint32_t along = around * 3;
    const double spacing = 2 * std::numbers::pi / std::sqrt(static_cast<double>(along * around) / 0.35);
    TriangleMesh mesh = test::torus_mesh(96, 40);
    const NarrowHandles found = close_handles(mesh, test::torus_samples(along, around), spacing, 0, true);
    EXPECT_EQ(found.closed, 0u) << around;
    EXPECT_EQ(found.genus, 1u) << around;
  }
}

TEST(NarrowHandles, SmallRingsOfAChainStay) {
  // Rings of 12 × 5 samples, between them bridges that no samples support.
  TriangleMesh mesh = test::torus_mesh(48, 24);
  PointSet points = test::torus_samples(16, 6);
  const PointSet ring = points;
  for (int i = 1; i < 4; ++i) {
    const Vec3f shift{2.75f * static_cast<float>(i), 0, 0};
    mesh = test::joined(mesh, test::torus_mesh(48, 24), shift);
    for (const Vec3f& p : ring.positions) points.positions.push_back(p + shift);
    points.normals.insert(points.normals.end(), ring.normals.begin(), ring.normals.end());
  }
  mesh = test::with_prism(mesh, {0, 0.65, 0}, {0, -0.65, 0});
  ASSERT_EQ(measure_topology(mesh).genus(), 5);
  const NarrowHandles found = close_handles(mesh, points, 0.37, 0, true);
  EXPECT_EQ(found.closed, 1u);
  EXPECT_EQ(found.genus, 4u);
}

TEST(NarrowHandles, OpenSurfacesLoseThemToo) {
  TriangleMesh mesh = spurious_torus();
  const auto is_low = [&](const Triangle& t) { return mesh.vertices[t[0]].x < -0.9f && mesh.vertices[t[0]].z > 0; };
  std::erase_if(mesh.triangles, is_low);
  const NarrowHandles found = close_handles(mesh, test::torus_samples(64, 24), kSpacing, 0, true);
  EXPECT_EQ(found.closed, 2u);
  EXPECT_EQ(found.genus, 1u);
  EXPECT_TRUE(measure_topology(mesh).manifold());
}

TEST(NarrowHandles, DoNotDependOnThreads) {
  const PointSet points = test::torus_samples(64, 24);
  test::expect_equal_for_any_threads([&] {
    TriangleMesh mesh = spurious_torus();
    close_handles(mesh, points, kSpacing, 0, true);
    return std::pair(mesh.vertices, mesh.triangles);
  });
}

}  // namespace
}  // namespace sansmesh::inline v1::detail
