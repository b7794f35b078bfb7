// Meshes of surfaces that are not made for meshing: their borders and block sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/model/surface_domain.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/reconstruct.h"
#include "sansmesh/search/kd_tree.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;

TriangleMesh surface_mesh(const PointSet& cloud, const char* name, ReconstructOptions options = {},
                          ReconstructReport* report = nullptr) {
  options.surface = {.method = name};
  Progress progress;
  ReconstructResult made = reconstruct(cloud, options, progress);
  if (report) *report = made.report;
  return std::move(made.mesh);
}

PointSet part_of(const PointSet& cloud, const std::function<bool(const Vec3f&)>& keep) {
  PointSet part;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (keep(cloud.positions[i])) {
      part.positions.push_back(cloud.positions[i]);
      part.normals.push_back(cloud.normals[i]);
    }
  return part;
}

double border_length(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  double length = 0;
  for (const auto& [edge, count] : edges)
    if (count == 1) length += static_cast<double>(norm(mesh.vertices[edge.first] - mesh.vertices[edge.second]));
  return length;
}

/// Random points of a rectangle in z = 0, lifted by half of x² / `radius`.
PointSet rectangle(std::size_t n, double a, double b, double radius = 100) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = a * uniform(generator);
    cloud.positions.push_back(Vec3f(Vec3{x, b * uniform(generator), 0.5 * x * x / radius}));
    cloud.normals.push_back(Vec3f(normalized(Vec3{-x / radius, 0, 1})));
  }
  return cloud;
}

class SurfaceMesh : public testing::TestWithParam<const char*> {};

// A half sphere ends in a circle with the circle's length, except for the waves of a contour half a spacing wide.
TEST_P(SurfaceMesh, OfAHalfSphereEndsInACircle) {
  const PointSet cloud = part_of(test::sphere(6000), [](const Vec3f& p) { return p.z < 0; });
  ReconstructReport report;
  const TriangleMesh mesh = surface_mesh(cloud, GetParam(), {}, &report);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_EQ(topology.euler, 1) << "a disc";
  EXPECT_TRUE(report.open);
  EXPECT_NEAR(border_length(mesh), 2 * kPi, 0.08 * 2 * kPi);
  for (const Vec3f& v : mesh.vertices) EXPECT_LT(static_cast<double>(v.z), 1.5 * report.spacing);
}

// Trimming opens a wide hole in a sphere, which would otherwise be closed, along the samples around it.
TEST_P(SurfaceMesh, IsTrimmedAtItsDistance) {
  const PointSet cloud = part_of(test::sphere(6000), [](const Vec3f& p) { return p.z < 0.8f; });
  for (const double share : {2.0, 0.0}) {
    ReconstructReport report;
    const double spacing = std::sqrt(4 * kPi / 6000);
    const double trim = share * spacing, limit = share > 0 ? trim : 4.2 * spacing;
    ReconstructOptions options;
    options.mesh.trim = trim;
    const TriangleMesh mesh = surface_mesh(cloud, GetParam(), options, &report);
    const KdTree samples(cloud.positions);
    for (const Vec3f& v : mesh.vertices)
      ASSERT_LT(std::sqrt(samples.nearest(v)->squared_distance), static_cast<float>(1.05 * limit));
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(topology.boundary_loops, 1u);
    EXPECT_NEAR(border_length(mesh), 2 * kPi * 0.6, 0.12 * 2 * kPi * 0.6);
  }
}

// Cubes have sharp convex edges and corners: no openings, no handles and nothing that sticks out.
TEST_P(SurfaceMesh, OfACubeIsClosedAndHasNoFins) {
  SANSMESH_NOT_SANITIZED("judges meshes; others mesh every surface");
  const PointSet cloud = test::cube(24000, 3);
  ReconstructReport report;
  const TriangleMesh mesh = surface_mesh(cloud, GetParam(), {}, &report);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.euler, 2);
  EXPECT_FALSE(report.open);
  for (const Vec3f& v : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) ASSERT_LT(std::abs(static_cast<double>(v[k])), 1 + 2 * report.spacing);
}

INSTANTIATE_TEST_SUITE_P(Names, SurfaceMesh, testing::Values("apss", "kolluri", "levin"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(SurfaceMesh, FewTrianglesWhereItIsFlat) {
  const PointSet cloud = rectangle(40000, 2, 1);
  Progress progress;
  const SurfaceModel model = make_surface_model(cloud, SurfaceOptions{}, progress);
  const PointSet feet = model.feet(progress);
  ASSERT_EQ(feet.size(), model.balls().centers.size());
  const std::size_t fine = model.blocks(1).leaves().size(), flat = model.blocks_for(feet, 1e-4).leaves().size();
  EXPECT_LT(20 * flat, fine);
  EXPECT_THROW(model.blocks_for(feet, 0), ArgumentError);
  EXPECT_THROW(model.blocks_for(PointSet{}, 1e-4), ArgumentError);
}

// Blocks are larger on a larger sphere with the same spacing, and the mesh is as accurate.
TEST(SurfaceMesh, BlocksFollowTheCurvature) {
  double last = 0;
  for (const std::size_t n : {4000u, 64000u}) {
    const PointSet cloud = test::sphere(n);
    ReconstructReport report;
    const TriangleMesh mesh = surface_mesh(cloud, "apss", {}, &report);
    const double per_sample = static_cast<double>(report.blocks) / static_cast<double>(n);
    if (last > 0) EXPECT_LT(per_sample, 0.6 * last);
    last = per_sample;
    double off = 0;
    for (const Triangle& t : mesh.triangles)
      off += std::abs(norm(Vec3(mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3) - 1);
    EXPECT_LT(off / static_cast<double>(mesh.triangles.size()), report.mesh_error);
  }
}

// Two sheets that face each other across a few spacings stay two, however flat they are.
TEST(SurfaceMesh, OfAThinPlateHasBothSides) {
  PointSet cloud;
  const double thick = 0.05;
  const PointSet side = rectangle(40000, 2, 1, 1e6);
  for (std::size_t i = 0; i < side.size(); ++i)
    for (const float up : {0.0f, 1.0f}) {
      cloud.positions.push_back(side.positions[i] + Vec3f{0, 0, up * static_cast<float>(thick)});
      cloud.normals.push_back({0, 0, up > 0 ? 1.0f : -1.0f});
    }
  const TriangleMesh mesh = surface_mesh(cloud, "apss");
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += 0.5 * norm(cross(Vec3(mesh.vertices[t[1]] - mesh.vertices[t[0]]),
                             Vec3(mesh.vertices[t[2]] - mesh.vertices[t[0]])));
  EXPECT_NEAR(area, 4, 0.15);
  // Beyond the samples the two sides meet in a rim.
  const auto beside = [](float c, float size) { return std::min(c, size - c) < 0; };
  for (const Vec3f& v : mesh.vertices)
    if (!beside(v.x, 2) && !beside(v.y, 1))
      ASSERT_LT(std::min(std::abs(v.z), std::abs(v.z - static_cast<float>(thick))), 0.2f * static_cast<float>(thick));
}

// A hole of eight spacings in a solid is closed, in an open sheet it is not.
TEST(SurfaceMesh, HolesOfSolidsAreClosed) {
  const PointSet cloud = part_of(test::sphere(20000), [](const Vec3f& p) { return p.z < 0.995f; });
  ReconstructReport report;
  EXPECT_TRUE(measure_topology(surface_mesh(cloud, "apss", {}, &report)).closed());
  EXPECT_FALSE(report.open);
  const PointSet half = part_of(cloud, [](const Vec3f& p) { return p.z > 0.5f; });
  EXPECT_EQ(measure_topology(surface_mesh(half, "apss", {}, &report)).boundary_loops, 2u);
  EXPECT_TRUE(report.open);
  ReconstructOptions fill;
  fill.mesh.fill_holes = 0.4;
  EXPECT_EQ(measure_topology(surface_mesh(half, "apss", fill)).boundary_loops, 1u);
}

TEST(SurfaceDomain, KnowsEndsFromEdges) {
  Progress progress;
  const auto ends = [&](const PointSet& cloud, std::optional<bool> solid = {}) {
    const SurfaceModel model = make_surface_model(cloud, SurfaceOptions{}, progress);
    return SurfaceDomain(model.field(progress), model.feet(progress), model.frame().from_input(model.report().spacing),
                         {}, {}, solid)
        .ends();
  };
  EXPECT_FALSE(ends(test::cube(12000)));
  EXPECT_FALSE(ends(test::sphere(4000)));
  EXPECT_TRUE(ends(part_of(test::cube(12000), [](const Vec3f& p) { return p.z < 1; })));
  EXPECT_TRUE(ends(rectangle(4000, 1, 1)));
  EXPECT_TRUE(ends(rectangle(4000, 1, 1), false));
}

TEST(SurfaceMesh, IsTheSameForAnyNumberOfThreads) {
  const PointSet cloud = part_of(test::torus(8000), [](const Vec3f& p) { return p.x < 0.7f; });
  test::compare_threads([&] { return surface_mesh(cloud, "apss"); },
                        [](const TriangleMesh& a, const TriangleMesh& b) {
                          EXPECT_EQ(a.vertices, b.vertices);
                          EXPECT_EQ(a.triangles, b.triangles);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
