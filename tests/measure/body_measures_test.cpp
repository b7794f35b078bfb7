#include "sansmesh/measure/body_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/field/placed_field.h"
#include "sansmesh/measure/section.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using std::numbers::pi;

/// Rotated about an axis by an angle.
TriangleMesh turned(TriangleMesh mesh, const Vec3& axis, double angle) {
  const Vec3 k = normalized(axis);
  for (Vec3f& v : mesh.vertices) {
    const Vec3 p(v);
    v = Vec3f(p * std::cos(angle) + cross(k, p) * std::sin(angle) + k * (dot(k, p) * (1 - std::cos(angle))));
  }
  return mesh;
}

TEST(MeasureSolid, BoxInAnyPosition) {
  for (const double angle : {0.0, 0.4, 1.1}) {
    TriangleMesh box = turned(test::box_mesh({-1, -2, -3}, {1, 2, 3}), {1, 2, -1}, angle);
    box.origin = {500, -300, 20};
    const SolidMeasures m = measure_solid(box);
    ASSERT_TRUE(m.whole.mass);
    EXPECT_NEAR(m.whole.area, 88, 1e-4);
    EXPECT_NEAR(m.whole.mass->volume, 48, 1e-4);
    EXPECT_NEAR(norm(m.whole.mass->center - box.origin), 0, 1e-6);
    EXPECT_NEAR(norm(m.whole.surface_center - box.origin), 0, 1e-6);
    // Volume / 12 · (sum of the squares of two sides).
    EXPECT_NEAR(m.whole.mass->moments[0], 4 * (4 + 16), 1e-3);
    EXPECT_NEAR(m.whole.mass->moments[1], 4 * (4 + 36), 1e-3);
    EXPECT_NEAR(m.whole.mass->moments[2], 4 * (16 + 36), 1e-3);
    EXPECT_NEAR(m.smallest_box.sizes[0], 6, 1e-4);
    EXPECT_NEAR(m.smallest_box.sizes[1], 4, 1e-4);
    EXPECT_NEAR(m.smallest_box.sizes[2], 2, 1e-4);
    EXPECT_NEAR(norm(m.smallest_box.center - box.origin), 0, 1e-4);
    // The axis of the smallest moment is the longest side.
    EXPECT_NEAR(std::abs(dot(m.whole.mass->axes[0], m.smallest_box.axes[0])), 1, 1e-5);
    for (const auto& axes : {m.whole.mass->axes, m.smallest_box.axes}) {
      EXPECT_NEAR(norm(cross(axes[0], axes[1]) - axes[2]), 0, 1e-9);
      EXPECT_NEAR(norm(axes[0]), 1, 1e-12);
    }
    EXPECT_EQ(m.components.size(), 1u);
    EXPECT_EQ(m.left_out, 0u);
  }
}

TEST(MeasureSolid, SphereConverges) {
  const SolidMeasures m = measure_solid(test::scaled(test::octasphere(6), 2));
  const double volume = 4.0 / 3 * pi * 8;
  EXPECT_NEAR(m.whole.mass->volume, volume, 1e-3 * volume);
  EXPECT_NEAR(m.whole.area, 16 * pi, 1e-3 * 16 * pi);
  for (const double moment : m.whole.mass->moments) EXPECT_NEAR(moment, 0.4 * volume * 4, 2e-3 * 0.4 * volume * 4);
}

TEST(MeasureSolid, TorusMoments) {
  const SolidMeasures m = measure_solid(test::torus_mesh(400, 200));
  const double r2 = 0.35 * 0.35, volume = 2 * pi * pi * r2;
  EXPECT_NEAR(m.whole.mass->volume, volume, 1e-3 * volume);
  EXPECT_NEAR(m.whole.mass->moments[2], volume * (1 + 0.75 * r2), 2e-3 * volume);
  EXPECT_NEAR(m.whole.mass->moments[0], volume * (0.5 + 5.0 / 8 * r2), 2e-3 * volume);
  EXPECT_NEAR(std::abs(m.whole.mass->axes[2].z), 1, 1e-6);
}

TEST(MeasureSolid, ComponentsCavitiesAndOpenParts) {
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {4, 4, 4});
  mesh = test::joined(mesh, test::turned_inside_out(test::box_mesh({1, 1, 1}, {2, 2, 2})), {});
  mesh = test::joined(mesh, test::scaled(test::octasphere(3), 0.5f), {10, 0, 0});
  SolidMeasures m = measure_solid(mesh);
  ASSERT_EQ(m.components.size(), 3u);
  EXPECT_NEAR(m.components[0].mass->volume, 64, 1e-9);
  EXPECT_NEAR(m.components[1].mass->volume, -1, 1e-9);
  EXPECT_GT(m.components[1].mass->moments[0], 0);
  EXPECT_NEAR(norm(m.components[1].mass->center - Vec3{1.5, 1.5, 1.5}), 0, 1e-9);
  EXPECT_NEAR(m.components[2].box.lower.x, 9.5, 1e-6);
  EXPECT_NEAR(m.whole.mass->volume, 63 + m.components[2].mass->volume, 1e-6);

  mesh.triangles.pop_back();  // opens the sphere
  m = measure_solid(mesh);
  EXPECT_FALSE(m.whole.closed());
  EXPECT_FALSE(m.whole.mass);
  EXPECT_TRUE(m.components[0].mass);
  EXPECT_FALSE(m.components[2].mass);
  EXPECT_EQ(m.components[2].open_edges, 3u);
}

TEST(MeasureSolid, DistinguishesSolidsCavitiesAndOverlaps) {
  const auto at = [](const Vec3f& low, const Vec3f& high, bool inward) {
    TriangleMesh box = test::box_mesh(low, high);
    return inward ? test::turned_inside_out(box) : box;
  };
  // A solid, a cavity in it, a solid in the cavity: a valid nesting. Faces touch, corners coincide in projection.
  TriangleMesh mesh = at({0, 0, 0}, {8, 8, 8}, false);
  mesh = test::joined(mesh, at({1, 1, 1}, {7, 7, 7}, true), {});
  mesh = test::joined(mesh, at({2, 2, 1}, {6, 6, 6}, false), {});
  SolidMeasures m = measure_solid(mesh);
  ASSERT_EQ(m.components.size(), 3u);
  EXPECT_EQ(m.components[0].surrounding, 0);
  EXPECT_EQ(m.components[1].surrounding, 1);
  EXPECT_EQ(m.components[2].surrounding, 0);
  for (const BodyMeasures& b : m.components) EXPECT_FALSE(b.misplaced());
  EXPECT_EQ(m.crossing_pairs, 0u);

  // A solid inside solid matter, and an inverted free one.
  mesh = test::joined(mesh, at({3, 3, 3}, {4, 4, 4}, false), {});
  mesh = test::joined(mesh, at({10, 10, 10}, {11, 11, 12}, true), {});
  m = measure_solid(mesh);
  ASSERT_EQ(m.components.size(), 5u);
  EXPECT_TRUE(m.components[3].misplaced());
  EXPECT_EQ(m.components[3].surrounding, 0) << "inside out, the larger one";
  EXPECT_TRUE(m.components[4].misplaced());
  EXPECT_EQ(m.components[4].surrounding, 1);
  EXPECT_EQ(m.crossing_pairs, 0u);
}

TEST(MeasureSolid, DuplicateBodiesAreNested) {
  // Faces coincide, and rounding must not decide which is above.
  for (int k = 0; k < 6; ++k) {
    SCOPED_TRACE(k);
    const TriangleMesh ball = turned(test::octasphere(2), {1, 0.3 * k, -2}, 0.37 * k + 0.1);
    SolidMeasures m = measure_solid(test::joined(ball, ball, {}));
    ASSERT_EQ(m.components.size(), 2u);
    for (const BodyMeasures& b : m.components) EXPECT_TRUE(b.misplaced());
    // A cavity filled by a body up to its walls is still a cavity.
    const TriangleMesh wall = turned(test::scaled(test::octasphere(2), 1.5f), {1, 0.3 * k, -2}, 0.37 * k + 0.1);
    m = measure_solid(test::joined(test::joined(wall, test::turned_inside_out(ball), {}), ball, {}));
    ASSERT_EQ(m.components.size(), 3u);
    for (const BodyMeasures& b : m.components) EXPECT_FALSE(b.misplaced());
  }
}

TEST(MeasureSolid, ManyLongBodiesBesideEachOther) {
  // Triangles far longer than wide; a ray crosses few of them.
  TriangleMesh rods;
  constexpr int n = 60;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3f low{static_cast<float>(i), static_cast<float>(j), 0};
      rods = test::joined(std::move(rods), test::box_mesh(low, low + Vec3f{0.5f, 0.5f, 100}), {});
    }
  const SolidMeasures m = measure_solid(rods);
  EXPECT_EQ(m.components.size(), std::size_t{n * n});
  EXPECT_EQ(std::count_if(m.components.begin(), m.components.end(), [](const auto& b) { return b.misplaced(); }), 0);
}

TEST(MeasureSolid, FindsIntersectingTriangles) {
  const TriangleMesh sphere = test::octasphere(4);
  EXPECT_EQ(measure_solid(sphere).crossing_pairs, 0u);
  const SolidMeasures apart = measure_solid(test::joined(sphere, sphere, {2.5f, 0, 0}));
  EXPECT_EQ(apart.crossing_components, 0u);
  const SolidMeasures overlapping = measure_solid(test::joined(sphere, sphere, {1, 0.01f, 0}));
  EXPECT_EQ(overlapping.crossing_components, 2u);
  EXPECT_GT(overlapping.crossing_pairs, 20u);
  for (const BodyMeasures& b : overlapping.components) EXPECT_FALSE(b.misplaced()) << "most of it stands free";
}

TEST(MeasureSolid, ClosedMeansBalancedEdges) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  std::swap(box.triangles[3][0], box.triangles[3][1]);
  EXPECT_EQ(measure_solid(box).whole.open_edges, 3u);  // its edges are traversed twice in the same direction
  // Two cubes with a common edge: four triangles there, but closed.
  TriangleMesh touching = test::joined(test::box_mesh({0, 0, 0}, {1, 1, 1}), test::box_mesh({1, 1, 0}, {2, 2, 1}), {});
  EXPECT_EQ(measure_solid(touching).components.size(), 2u) << "only touch";
  for (Triangle& t : touching.triangles)
    for (std::uint32_t& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
  const SolidMeasures m = measure_solid(touching);
  EXPECT_EQ(m.components.size(), 1u);
  EXPECT_FALSE(m.topology.manifold());
  EXPECT_TRUE(m.whole.closed());
  EXPECT_EQ(m.whole.nonmanifold_edges, 1u);
  EXPECT_NEAR(m.whole.mass->volume, 2, 1e-9);
}

TEST(MeasureSolid, SoupsAndBadTriangles) {
  const TriangleMesh sphere = test::octasphere(3);
  TriangleMesh soup;
  for (const Triangle& t : sphere.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(sphere.vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  const auto n = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.push_back({NAN, 0, 0});
  soup.triangles.push_back({0, 1, n});
  soup.triangles.push_back({0, 1, n + 7});
  soup.triangles.push_back({0, 0, 1});
  const SolidMeasures m = measure_solid(soup);
  EXPECT_EQ(m.left_out, 3u);
  EXPECT_TRUE(m.whole.closed());
  EXPECT_EQ(m.components.size(), 1u);
  EXPECT_NEAR(m.whole.mass->volume, measure_solid(sphere).whole.mass->volume, 1e-9);
  EXPECT_THROW(measure_solid({}), DataError);
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_THROW(measure_solid(flat), DataError);
}

TEST(MeasureSolid, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh torus = turned(test::torus_mesh(300, 150), {1, 1, 0}, 0.3);
  test::compare_threads([&] { return measure_solid(torus); },
                        [](const SolidMeasures& one, const SolidMeasures& many) {
                          EXPECT_EQ(one.whole.mass->volume, many.whole.mass->volume);
                          EXPECT_EQ(one.whole.mass->moments, many.whole.mass->moments);
                          EXPECT_EQ(one.smallest_box.sizes, many.smallest_box.sizes);
                        });
}

TEST(PlacedField, IsTheFieldElsewhere) {
  const test::SphereField sphere(1);
  const PlacedField placed(sphere, {{100, 200, 300}, 4});
  const Vec3 x{100, 208, 300};
  double value = 0;
  Vec3 gradient;
  placed.evaluate({&x, 1}, {&value, 1}, {&gradient, 1});
  EXPECT_NEAR(value, 4, 1e-12);
  EXPECT_NEAR(norm(gradient - Vec3{0, 1, 0}), 0, 1e-12);
  EXPECT_NEAR(section_field(placed, axis_plane(2, 300)).area, 16 * pi, 1e-3);
}

}  // namespace
}  // namespace sansmesh::inline v1
