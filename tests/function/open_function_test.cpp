// Open surfaces: their meshes end where the samples end.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "edit_shapes.h"
#include "io/io_test_tools.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/places.h"
#include "support/same_bytes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// A square [0, 1]², slightly curved, with noise, except for a disc around its centre.
PointSet noisy_square(std::size_t n, float noise, float hole = 0) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::normal_distribution<float> gauss(0, 1);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3f p{uniform(random), uniform(random), noise * gauss(random)};
    if (norm(Vec3f{p.x - 0.5f, p.y - 0.5f, 0}) < hole) continue;
    p.z += 0.05f * std::sin(3 * p.x);
    cloud.positions.push_back(p);
    cloud.normals.push_back(normalized(Vec3f{-0.15f * std::cos(3 * p.x), 0, 1}));
  }
  return cloud;
}

TriangleMesh open_mesh(const FittedFunction& function, const MeshOptions& options = {}, MeshReport* report = nullptr) {
  Progress progress;
  return mesh_function(function, options, progress, report);
}

long euler_of(const TriangleMesh& mesh) { return measure_topology(mesh).euler; }

double farthest_sample(const TriangleMesh& mesh, const PointSet& cloud) {
  const ClosestTriangle closest(mesh);
  double most = 0;
  for (const Vec3f& p : cloud.positions) most = std::max(most, closest.closest(Vec3(p)).squared_distance);
  return std::sqrt(most);
}

TEST(OpenFunction, ASheetIsASheet) {
  for (const float noise : {0.0f, 0.002f}) {
    const PointSet cloud = noisy_square(40000, noise);
    const double spacing = 0.005;
    MeshReport report;
    const TriangleMesh mesh = open_mesh(fitted(cloud), {}, &report);
    EXPECT_TRUE(report.open);
    EXPECT_EQ(report.lost, 0);
    EXPECT_TRUE(measure_topology(mesh).manifold());
    EXPECT_EQ(euler_of(mesh), 1);  // one piece without a hole
    EXPECT_NEAR(measure_size(mesh).area, 1, 0.03);
    EXPECT_LT(farthest_sample(mesh, cloud), 2 * spacing + 4 * static_cast<double>(noise));
    for (const Vec3f& v : mesh.vertices) {
      const double beyond = std::max({-v.x, v.x - 1, -v.y, v.y - 1});
      ASSERT_LT(beyond, 2 * spacing);
    }
  }
}

TEST(OpenFunction, WideHolesStayUnlessFillingIsAskedFor) {
  const FittedFunction function = fitted(noisy_square(40000, 0, 0.1f));
  const TriangleMesh mesh = open_mesh(function);
  EXPECT_EQ(euler_of(mesh), 0);
  EXPECT_NEAR(measure_size(mesh).area, 1 - 0.01 * std::numbers::pi, 0.03);
  MeshOptions filled;
  filled.fill_holes = 0.3;
  const TriangleMesh whole = open_mesh(function, filled);
  EXPECT_EQ(euler_of(whole), 1);
  EXPECT_NEAR(measure_size(whole).area, 1, 0.1);  // and hardly beyond the border
}

TEST(OpenFunction, WhatIsClosedStaysClosedBesideAnOpenFloor) {
  const PointSet scene = joined(noisy_square(20000, 0), sphere(8000), 0.2f, {0.5f, 0.5f, 0.4f});
  const TriangleMesh mesh = open_mesh(fitted(scene));
  const MeshComponents parts = find_components(mesh);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(euler_of(mesh), 1 + 2);  // a disc and a sphere
}

TEST(OpenFunction, AFloorAboveAClosedThingMakesNoMembrane) {
  PointSet floor = noisy_square(20000, 0);
  for (Vec3f& p : floor.positions) p = (p - Vec3f{0.5f, 0.5f, 0}) * 6.0f + Vec3f{0, 0, 1.5f};
  const TriangleMesh mesh = open_mesh(fitted(joined(sphere(8000), floor)));
  EXPECT_NEAR(measure_size(mesh).area, 4 * std::numbers::pi + 36, 1.5);
}

TEST(OpenFunction, OfFewSamplesIsNotCappedAtTheCube) {
  for (const std::size_t n : {30u, 100u}) {
    const PointSet cloud = noisy_square(n, 0.01f);
    const TriangleMesh mesh = open_mesh(fitted(cloud));
    EXPECT_GT(measure_topology(mesh).boundary_edges, 0u) << n;
    for (const Vec3f& v : mesh.vertices) ASSERT_LT(std::abs(v.z), 0.15f) << n;
  }
}

TEST(OpenFunction, EndsAboutThereAlsoIfTheSamplesAreNotKept) {
  FittedFunction function = fitted(noisy_square(20000, 0));
  function.samples = std::make_shared<PointSet>();
  const TriangleMesh mesh = open_mesh(function);
  EXPECT_NEAR(measure_size(mesh).area, 1.006, 0.3);  // up to half a block more on every side
}

TEST(OpenFunction, IsKeptInFiles) {
  const Folder folder;
  const FittedFunction before = fitted(noisy_square(5000, 0));
  write_fitted_function(folder / "sheet.smf", before);
  const FittedFunction after = read_fitted_function(folder / "sheet.smf");
  EXPECT_EQ(after.field.report().open_area, before.field.report().open_area);
  EXPECT_EQ(after.field.report().mean_winding_number, before.field.report().mean_winding_number);
  EXPECT_TRUE(same_bytes(open_mesh(before).vertices, open_mesh(after).vertices));
}

TEST(OpenFunction, DoesNotDependOnTheThreads) {
  const FittedFunction function = fitted(noisy_square(8000, 0.002f, 0.1f));
  compare_threads([&] { return open_mesh(function); },
                  [](const TriangleMesh& one, const TriangleMesh& many) {
                    EXPECT_TRUE(same_bytes(one.vertices, many.vertices));
                    EXPECT_TRUE(same_bytes(one.triangles, many.triangles));
                  });
}

TEST(OpenFunction, TrimmingCutsAClosedSurfaceWhereItsSamplesEnd) {
  PointSet cap = sphere(20000);
  for (std::size_t i = cap.size(); i-- > 0;)
    if (cap.positions[i].z > 0.9f) {
      cap.positions.erase(cap.positions.begin() + static_cast<std::ptrdiff_t>(i));
      cap.normals.erase(cap.normals.begin() + static_cast<std::ptrdiff_t>(i));
    }
  const FittedFunction function = fitted(cap);
  EXPECT_EQ(function.field.report().open_area, 0);
  EXPECT_EQ(euler_of(open_mesh(function)), 2);
  MeshOptions options;
  options.trim = 0.05;
  const TriangleMesh mesh = open_mesh(function, options);
  EXPECT_EQ(euler_of(mesh), 1);
  for (const Vec3f& v : mesh.vertices) ASSERT_LT(v.z, 0.9f + 0.06f);
  EXPECT_NEAR(measure_size(mesh).area, 2 * std::numbers::pi * 1.9 + 0.05 * 2 * std::numbers::pi * 0.44, 0.1);
}

TEST(OpenFunction, SamplesWithoutSurfaceAreCountedAndFound) {
  const PointSet ball = sphere(9000), stray = joined(ball, sphere(1000), 0.1f, {3, 1, 2});
  const TriangleMesh mesh = open_mesh(fitted(ball));
  MeshReport report;
  detail::report_lost(mesh, {}, stray, 0.04, 0, {}, report);
  EXPECT_NEAR(report.lost, 0.1, 1e-9);
  ASSERT_TRUE(report.most_lost);
  EXPECT_LT(norm(*report.most_lost - Vec3{3, 1, 2}), 0.15);
  detail::report_lost(mesh, {}, ball, 0.04, 0, {}, report);
  EXPECT_EQ(report.lost, 0);
}

}  // namespace
}  // namespace sansmesh::inline v1
