#include "sansmesh/mesh/repair/fill_holes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh_measures.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {
namespace {

/// Removes the triangles whose centre fulfils `goes`.
TriangleMesh without(TriangleMesh mesh, const std::function<bool(const Vec3f&)>& goes) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return goes((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.f);
  });
  return mesh;
}

TriangleMesh sphere_with_holes(int levels) {
  return without(octasphere(levels), [](const Vec3f& p) { return p.z > 0.9f || p.x < -0.97f || p.y > 0.985f; });
}

TEST(FillHoles, ASphereBecomesOneAgain) {
  TriangleMesh mesh = sphere_with_holes(5);
  ASSERT_FALSE(measure_topology(mesh).closed());
  for (const Vec3f& v : mesh.vertices) mesh.normals.push_back(normalized(v));
  std::vector<float> height;
  for (const Vec3f& v : mesh.vertices) height.push_back(v.z), mesh.colors.push_back({200, 100, 50});
  mesh.attributes.set("height", height);
  mesh.triangle_attributes.set("part", std::vector<int>(mesh.triangles.size(), 7));
  const std::size_t old = mesh.vertices.size();
  FillOptions options;
  options.share = 0.5;
  Progress progress;
  const FillReport report = fill_holes(mesh, options, progress);
  EXPECT_EQ(report.found.loops.size(), 3u);
  EXPECT_EQ(report.filled, 3u);
  EXPECT_TRUE(measure_topology(mesh).closed());
  EXPECT_GT(report.vertices, 50u);
  // The cap over the widest hole is 0.1 high: its filling is spherical, not flat.
  double worst = 0;
  for (std::size_t v = old; v < mesh.vertices.size(); ++v) {
    worst = std::max(worst, std::abs(static_cast<double>(norm(mesh.vertices[v])) - 1));
    EXPECT_GT(dot(mesh.normals[v], normalized(mesh.vertices[v])), 0.97f);
  }
  EXPECT_LT(worst, 0.012);
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.colors.back(), (std::array<std::uint8_t, 3>{200, 100, 50}));
  ASSERT_EQ(mesh.attributes.find("height")->rows(), mesh.vertices.size());
  EXPECT_NEAR((*mesh.attributes.find<float>("height"))[old], 0.9, 0.12);
  EXPECT_EQ(mesh.triangle_attributes[0].rows(), mesh.triangles.size());

  TriangleMesh drum = sphere_with_holes(5);
  options.fair = false;
  const std::size_t before = drum.vertices.size();
  fill_holes(drum, options, progress);
  EXPECT_TRUE(measure_topology(drum).closed());
  double lowest = 1;
  for (std::size_t v = before; v < drum.vertices.size(); ++v)
    lowest = std::min(lowest, static_cast<double>(norm(drum.vertices[v])));
  EXPECT_LT(lowest, 0.92);
}

TEST(FillHoles, BySize) {
  const TriangleMesh mesh = sphere_with_holes(4);
  const HoleLoops found = find_holes(mesh);
  ASSERT_EQ(found.loops.size(), 3u);
  EXPECT_EQ(found.stray_edges, 0u);
  EXPECT_GE(found.loops[0].diameter, found.loops[1].diameter);
  EXPECT_GT(found.loops[0].middle.z, 0.8);
  Progress progress;
  const auto filled = [&](const FillOptions& options) {
    TriangleMesh copy = mesh;
    return fill_holes(copy, options, progress).filled;
  };
  FillOptions by_length;
  by_length.largest = 1.01 * found.loops[1].diameter;
  EXPECT_EQ(filled(by_length), 2u);
  FillOptions by_edges;
  by_edges.edges = found.loops[2].vertices.size();
  EXPECT_EQ(filled(by_edges), 1u);
  FillOptions all;
  all.all = true;
  EXPECT_EQ(filled(all), 3u);
  EXPECT_LT(filled({}), 3u);  // the widest hole is a third of the sphere
}

TEST(FillHoles, OuterBordersStay) {
  TriangleMesh sheet = without(octasphere(4), [](const Vec3f& p) { return p.z < 0.1f || p.z > 0.985f; });
  Progress progress;
  const FillReport report = fill_holes(sheet, {}, progress);
  EXPECT_EQ(report.filled, 1u);
  EXPECT_EQ(report.too_large, 1u);
  EXPECT_EQ(measure_topology(sheet).boundary_loops, 1u);
}

/// Tube of radius 1 around z, open at both ends, with a hole in its side.
TriangleMesh tube_with_a_hole() {
  TriangleMesh tube;
  const std::uint32_t around = 32, along = 60;
  for (std::uint32_t j = 0; j <= along; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * i / around;
      tube.vertices.push_back(Vec3f(Vec3{std::cos(a), std::sin(a), 0.4 * j}));
      if (j == along) continue;
      const std::uint32_t v = j * around + i, w = j * around + (i + 1) % around;
      if (j >= 30 && j < 33 && i < 3) continue;
      tube.triangles.push_back({v, w, w + around});
      tube.triangles.push_back({v, w + around, v + around});
    }
  return tube;
}

TEST(FillHoles, EndsStayOpenUnlessAskedFor) {
  // The ends measure 12 % of the tube: below the limit, but they are not holes.
  TriangleMesh tube = tube_with_a_hole();
  Progress progress;
  const FillReport report = fill_holes(tube, {}, progress);
  ASSERT_EQ(report.found.loops.size(), 3u);
  EXPECT_LT(report.found.loops[0].share, FillOptions().share);
  EXPECT_NEAR(report.found.loops[0].steepness, 1, 0.01);
  EXPECT_NEAR(report.found.loops[1].steepness, 1, 0.01);
  EXPECT_LT(report.found.loops[2].steepness, 0.3);
  EXPECT_EQ(report.ends, 2u);
  EXPECT_EQ(report.filled, 1u);
  EXPECT_EQ(report.too_large, 0u);
  EXPECT_EQ(measure_topology(tube).boundary_loops, 2u);
  TriangleMesh closed = tube_with_a_hole();
  FillOptions options;
  options.largest = 1.01 * report.found.loops[0].diameter;
  EXPECT_EQ(fill_holes(closed, options, progress).filled, 3u);
  EXPECT_TRUE(measure_topology(closed).closed());
}

TEST(FillHoles, TouchingHolesSeamsAndLongLoops) {
  // Two triangles with a common vertex are missing: two holes of three edges, not one of six.
  TriangleMesh two = octasphere(3);
  const Triangle first = two.triangles[0];
  std::size_t other = 1;
  while ([&] {
    int shared = 0;
    for (const std::uint32_t v : two.triangles[other])
      for (const std::uint32_t w : first) shared += v == w;
    return shared != 1;
  }())
    ++other;
  two.triangles.erase(two.triangles.begin() + static_cast<std::ptrdiff_t>(other));
  two.triangles.erase(two.triangles.begin());
  const HoleLoops loops = find_holes(two);
  ASSERT_EQ(loops.loops.size(), 2u);
  EXPECT_EQ(loops.loops[0].vertices.size(), 3u);
  Progress progress;
  EXPECT_EQ(fill_holes(two, {}, progress).filled, 2u);
  EXPECT_TRUE(measure_topology(two).closed());

  // A triangle soup without gaps has no holes, and becomes one mesh.
  TriangleMesh soup;
  for (const Triangle& t : octasphere(2).triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(octasphere(2).vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  EXPECT_EQ(find_holes(soup).loops.size(), 0u);
  EXPECT_GT(join_equal_vertices(soup).joined, 0u);
  EXPECT_TRUE(measure_topology(soup).closed());

  // A loop too long for the exact algorithm.
  TriangleMesh cut = without(torus_mesh(300, 12), [](const Vec3f& p) { return p.z > 0.25f; });
  FillOptions all;
  all.all = true;
  const FillReport report = fill_holes(cut, all, progress);
  EXPECT_GT(report.found.loops[0].vertices.size(), 250u);
  EXPECT_EQ(report.filled, report.found.loops.size());
  EXPECT_TRUE(measure_topology(cut).closed());
}

TEST(FillHoles, LongJaggedBordersAreCrossed) {
  // Square of n × n quads around a round hole of some 400 edges; many triangles at it have two border edges.
  constexpr std::uint32_t n = 130;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t k = 0; k <= n; ++k)
      mesh.vertices.push_back({static_cast<float>(i), static_cast<float>(k) + 0.4f * static_cast<float>(i % 2), 0});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = i * (n + 1) + k, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  const double whole = measure_quality(mesh).area;
  mesh = without(mesh, [](const Vec3f& p) { return norm(p - Vec3f{65, 65, 0}) < 50; });
  Progress progress;
  FillOptions options;
  options.largest = 150;
  const FillReport report = fill_holes(mesh, options, progress);
  EXPECT_EQ(report.filled, 1u);
  EXPECT_EQ(report.failed, 0u);
  EXPECT_GT(report.found.loops[1].vertices.size(), 240u);
  EXPECT_EQ(measure_topology(mesh).boundary_loops, 1u);
  EXPECT_EQ(measure_topology(mesh).nonmanifold_edges, 0u);
  EXPECT_NEAR(measure_quality(mesh).area, whole, 1e-3 * whole);  // no triangle folds over another
}

TEST(FillHoles, ExistingEdgesAreSplit) {
  // An octahedron without the four triangles around a vertex, whose square hole has both diagonals already.
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {2, 2, -2}, {2, -2, -3}};
  for (std::uint32_t k = 0; k < 4; ++k) mesh.triangles.push_back({(k + 1) % 4, k, 4});
  mesh.triangles.push_back({0, 2, 5});
  mesh.triangles.push_back({1, 3, 6});
  Progress progress;
  FillOptions options;
  options.edges = 4, options.refine = false;
  const FillReport report = fill_holes(mesh, options, progress);
  EXPECT_GE(report.filled, 1u);
  EXPECT_EQ(report.failed, 0u);
  EXPECT_EQ(measure_topology(mesh).nonmanifold_edges, 0u);
}

TEST(FillHoles, WhatIsNotManifoldIsNamed) {
  TriangleMesh fins = without(octasphere(3), [](const Vec3f& p) { return p.z > 0.95f; });
  // A fin on a border edge: the border branches there.
  const HoleLoop loop = find_holes(fins).loops[0];
  fins.vertices.push_back({0, 0, 3});
  const auto tip = static_cast<std::uint32_t>(fins.vertices.size() - 1);
  fins.triangles.push_back({loop.vertices[0], loop.vertices[1], tip});
  fins.triangles.push_back({loop.vertices[1], loop.vertices[0], tip});
  const HoleLoops found = find_holes(fins);
  EXPECT_GT(found.nonmanifold_edges + found.stray_edges, 0u);
  Progress progress;
  const std::size_t before = measure_topology(fins).nonmanifold_edges;
  fill_holes(fins, {}, progress);
  EXPECT_LE(measure_topology(fins).nonmanifold_edges, before);
}

TEST(FillHoles, AnyThreadsAndBadOptions) {
  expect_equal_for_any_threads([] {
    TriangleMesh mesh = sphere_with_holes(4);
    FillOptions all;
    all.all = true;
    Progress progress;
    fill_holes(mesh, all, progress);
    return std::pair(mesh.vertices, mesh.triangles);
  });
  FillOptions bad;
  bad.largest = 0;
  EXPECT_THROW(bad.validate(), ArgumentError);
  bad = {};
  bad.edges = 2;
  EXPECT_THROW(bad.validate(), ArgumentError);
  bad = {};
  bad.all = true, bad.edges = 5;
  EXPECT_THROW(bad.validate(), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::test
