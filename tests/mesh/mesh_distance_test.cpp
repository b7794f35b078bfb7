#include "sansmesh/mesh/mesh_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

SurfaceDistance measure(const TriangleMesh& a, const TriangleMesh& b, std::size_t samples = 20000) {
  Progress progress;
  return measure_distance(a, b, {.samples = samples}, progress);
}

TriangleMesh scaled(TriangleMesh mesh, float s) {
  for (Vec3f& v : mesh.vertices) v = s * v;
  return mesh;
}

TEST(ClosestTriangle, AgreesWithAskingEveryTriangle) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto random = [&] { return Vec3f{uniform(generator), uniform(generator), uniform(generator)}; };
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 700; ++i) {
    const Vec3f p = random();
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(p + 0.2f * random());
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.vertices[30] = mesh.vertices[31];  // without area
  mesh.vertices[60].x = std::numeric_limits<float>::quiet_NaN();
  const ClosestTriangle tree(mesh);
  ClosestTriangle::Hit hint;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 q(2.0f * random());
    double best = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles) {
      if (t[0] == 60) continue;
      best = std::min(best, squared_norm(closest_on_triangle(q, Vec3(mesh.vertices[t[0]]), Vec3(mesh.vertices[t[1]]),
                                                             Vec3(mesh.vertices[t[2]])) -
                                         q));
    }
    const ClosestTriangle::Hit plain = tree.closest(q);
    hint = tree.closest(q, hint);
    EXPECT_NEAR(plain.squared_distance, best, 1e-12);
    EXPECT_NEAR(hint.squared_distance, best, 1e-12);
    EXPECT_NEAR(squared_norm(plain.point - q), best, 1e-12);
    EXPECT_NE(plain.triangle, 20u);
  }
}

TEST(ClosestTriangle, TheClosestPointIsNoFartherThanAnyOtherOfTheTriangle) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1, 1), unit(0, 1);
  const auto random = [&] { return Vec3{uniform(generator), uniform(generator), uniform(generator)}; };
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = random(), b = random(), c = random(), q = 2.0 * random();
    const double distance = norm(closest_on_triangle(q, a, b, c) - q);
    for (int k = 0; k < 100; ++k) {
      double u = unit(generator), v = unit(generator);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      EXPECT_LE(distance, norm(a + u * (b - a) + v * (c - a) - q) + 1e-12);
    }
  }
}

TEST(MeshDistance, NoneFromAMeshToItself) {
  const TriangleMesh torus = test::torus_mesh(40, 20);
  const SurfaceDistance d = measure(torus, torus);
  EXPECT_LT(d.to_reference.max, 1e-6);
  EXPECT_LT(d.from_reference.rms, 1e-6);
  EXPECT_LT(*d.to_reference.signed_angle, 0.01);
}

TEST(MeshDistance, ConcentricSpheres) {
  const TriangleMesh inner = test::octasphere(6), outer = scaled(inner, 1.1f);
  const SurfaceDistance d = measure(outer, inner);
  for (const OneWayDistance& way : {d.to_reference, d.from_reference}) {
    EXPECT_NEAR(way.mean, 0.1, 1e-3);
    EXPECT_NEAR(way.rms, 0.1, 1e-3);
    EXPECT_NEAR(way.p95, 0.1, 1e-3);
    EXPECT_NEAR(way.max, 0.1, 1e-3);
    EXPECT_LT(*way.angle, 1.5);  // angle between neighbouring triangles
    EXPECT_EQ(way.samples, 20000u);
  }
  EXPECT_NEAR(d.diagonal, 2 * std::sqrt(3.0), 1e-5);
  EXPECT_NEAR(d.percent(d.diagonal), 100, 1e-12);
}

TEST(MeshDistance, SidesAreToldApart) {
  const TriangleMesh sphere = test::octasphere(4), more = test::joined(sphere, sphere, {10, 0, 0});
  const SurfaceDistance d = measure(sphere, more);
  EXPECT_LT(d.to_reference.max, 1e-6);
  EXPECT_NEAR(d.from_reference.mean, 0.5 * (10 + 1.0 / 30 - 1), 0.01);  // E‖c + n‖ = ‖c‖ + 1/(3 ‖c‖) for unit n
  EXPECT_NEAR(d.from_reference.max, 10, 1e-3);
}

TEST(MeshDistance, NormalsAndTheirSigns) {
  TriangleMesh inside_out = test::octasphere(4);
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  const SurfaceDistance d = measure(inside_out, test::octasphere(4));
  EXPECT_LT(*d.to_reference.angle, 0.01);
  EXPECT_GT(*d.to_reference.signed_angle, 179.9);
}

TEST(MeshDistance, MaximumIncludesVertices) {
  TriangleMesh spike = test::octasphere(3);
  const auto tip = static_cast<std::uint32_t>(spike.vertices.size());
  spike.vertices.push_back({0, 0, 50});
  spike.vertices.push_back({1e-4f, 0, 49});
  spike.triangles.push_back({tip, tip + 1, 4});
  EXPECT_NEAR(measure(spike, test::octasphere(3)).to_reference.max, 49, 1e-4);
}

TEST(MeshDistance, PointsOnEitherSide) {
  const TriangleMesh mesh = test::octasphere(6), cloud = to_mesh(test::sphere(20000));
  const SurfaceDistance there = measure(cloud, mesh), back = measure(mesh, cloud), both = measure(cloud, cloud);
  EXPECT_LT(there.to_reference.max, 1e-3);
  EXPECT_EQ(there.to_reference.samples, 20000u);
  EXPECT_DOUBLE_EQ(there.to_reference.mean, back.from_reference.mean);
  EXPECT_DOUBLE_EQ(there.from_reference.mean, back.to_reference.mean);
  EXPECT_GT(there.from_reference.mean, 0.002);  // about the spacing
  EXPECT_LT(there.from_reference.mean, 0.03);
  EXPECT_LT(*there.to_reference.signed_angle, 1.5);
  EXPECT_EQ(both.to_reference.max, 0);
  TriangleMesh bare = cloud;
  bare.normals.clear();
  EXPECT_FALSE(measure(bare, mesh).to_reference.angle);
  EXPECT_FALSE(measure(bare, mesh).from_reference.angle);
}

TEST(MeshDistance, OriginsMayDiffer) {
  const TriangleMesh here = test::octasphere(4);
  TriangleMesh there = here;
  there.origin = {500000, -3, 2};
  for (Vec3f& v : there.vertices) v = v + Vec3f{-1, 3, -2};
  TriangleMesh shifted = here;
  shifted.origin = {499999, 0, 0};
  EXPECT_LT(measure(there, shifted).to_reference.max, 1e-5);
  EXPECT_GT(measure(there, here).to_reference.mean, 499990);
}

TEST(MeshDistance, SamplesAreEvenInArea) {
  // A fine and a coarse square side by side: the mean distance to a plane shows the distribution of the samples.
  TriangleMesh mesh;
  for (int i = 0; i <= 32; ++i)
    for (int j = 0; j <= 32; ++j) mesh.vertices.push_back({static_cast<float>(i) / 32, static_cast<float>(j) / 32, 0});
  for (std::uint32_t i = 0; i < 32; ++i)
    for (std::uint32_t j = 0; j < 32; ++j) {
      const std::uint32_t a = i * 33 + j;
      mesh.triangles.push_back({a, a + 33, a + 34});
      mesh.triangles.push_back({a, a + 34, a + 1});
    }
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3f& v : {Vec3f{1, 0, 1}, Vec3f{2, 0, 1}, Vec3f{2, 1, 1}, Vec3f{1, 1, 1}}) mesh.vertices.push_back(v);
  mesh.triangles.push_back({base, base + 1, base + 2});
  mesh.triangles.push_back({base, base + 2, base + 3});
  TriangleMesh floor;
  floor.vertices = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  const SurfaceDistance d = measure(mesh, floor, 10000);
  EXPECT_NEAR(d.to_reference.mean, 0.5, 1e-3);
  EXPECT_NEAR(d.to_reference.rms, std::sqrt(0.5), 1e-3);
}

TEST(MeshDistance, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh a = test::torus_mesh(200, 100), b = test::torus_mesh(90, 40);
  test::compare_threads([&] { return measure(a, b); },
                        [](const SurfaceDistance& one, const SurfaceDistance& many) {
                          EXPECT_EQ(one.to_reference.mean, many.to_reference.mean);
                          EXPECT_EQ(one.from_reference.rms, many.from_reference.rms);
                          EXPECT_EQ(one.to_reference.max, many.to_reference.max);
                          EXPECT_EQ(*one.from_reference.angle, *many.from_reference.angle);
                        });
}

TEST(MeshDistance, BadInput) {
  const TriangleMesh sphere = test::octasphere(2);
  EXPECT_THROW(measure({}, sphere), DataError);
  EXPECT_THROW(measure(sphere, {}), DataError);
  EXPECT_THROW(measure(sphere, sphere, 0), ArgumentError);
  TriangleMesh flat;
  flat.vertices = {{0, 0, 3}, {1, 0, 3}, {2, 0, 3}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_NEAR(measure(flat, sphere).to_reference.max, std::sqrt(13.0) - 1, 0.02);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(measure_distance(sphere, sphere, {}, progress), Cancelled);
}

}  // namespace
}  // namespace sansmesh::inline v1
