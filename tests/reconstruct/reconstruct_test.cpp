#include "sansmesh/reconstruct.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/partition/partition_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangulation/block_tree.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

TriangleMesh run(const PointSet& cloud, const ReconstructOptions& options = {}, ReconstructReport* report = nullptr) {
  Progress progress;
  ReconstructResult made = reconstruct(cloud, options, progress);
  if (report) {
    *report = made.report;
    report->notes = made.notes;
  }
  return std::move(made.mesh);
}

TEST(Reconstruct, FindsTheTopologyWithAndWithoutNormals) {
  for (const bool normals : {true, false}) {
    PointSet ball = test::sphere(4000), ring = test::torus(6000);
    if (!normals) ball.normals.clear(), ring.normals.clear();
    const MeshTopology b = measure_topology(run(ball)), r = measure_topology(run(ring));
    EXPECT_TRUE(b.closed());
    EXPECT_EQ(b.components, 1u);
    EXPECT_EQ(b.genus(), 0);
    EXPECT_TRUE(r.closed());
    EXPECT_EQ(r.components, 1u);
    EXPECT_EQ(r.genus(), 1);
  }
}

TEST(Reconstruct, FacesOutwardWhateverTheNormalsSay) {
  PointSet cloud = test::sphere(4000);
  for (Vec3f& n : cloud.normals) n = -n;
  ReconstructReport report;
  const TriangleMesh mesh = run(cloud, {}, &report);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].text.find("inward"), std::string::npos);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    ASSERT_GT(dot(mesh.normals[i], normalized(mesh.vertices[i])), 0.95f);
  ReconstructOptions anew;
  anew.cloud.normals = NormalUse::estimate;
  EXPECT_TRUE(measure_topology(run(cloud, anew)).closed());
}

// Samples farther apart than half the thickness of a wall still distinguish its two sides, for any cells of the tree.
TEST(Reconstruct, FollowsBothSidesOfThinWalls) {
  constexpr float kInner = 0.93f;
  for (const std::size_t n : {7000u, 9000u, 12000u}) {
    const auto fewer = static_cast<std::size_t>(kInner * kInner * static_cast<float>(n));
    PointSet inner = test::sphere(fewer, 0.0, 2u);
    for (Vec3f& normal : inner.normals) normal = -normal;
    const TriangleMesh mesh = run(test::joined(test::sphere(n), inner, kInner));
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_TRUE(topology.closed()) << n;
    EXPECT_EQ(topology.components, 2u) << n;
    EXPECT_EQ(topology.genus(), 0) << n;
    double off = 0;
    for (const Vec3f& x : mesh.vertices)
      off += static_cast<double>(std::min(std::abs(norm(x) - 1), std::abs(norm(x) - kInner)));
    EXPECT_LT(off, 0.1 * static_cast<double>(1 - kInner) * static_cast<double>(mesh.vertices.size())) << n;
  }
}

// A cap without samples is farther from the samples towards its middle, and has low confidence there.
TEST(Reconstruct, MarksWhatWasInvented) {
  constexpr float kUnit = 1000;
  PointSet cloud, whole = test::sphere(6000);
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole.positions[i].z < 0.8f) {
      cloud.positions.push_back(whole.positions[i] * kUnit);
      cloud.normals.push_back(whole.normals[i]);
    }
  cloud.origin = {1e6, 0, 0};
  for (const bool other : {false, true}) {
    ReconstructOptions options;
    if (other) options.surface = {};
    options.fit.open = false;
    EXPECT_EQ(run(other ? whole : cloud, options).attributes.find("confidence"), nullptr) << "closed";
    options.mesh.confidence = true;
    const TriangleMesh mesh = run(cloud, options);
    const auto* const distance = mesh.attributes.find<float>("distance");
    const auto* const confidence = mesh.attributes.find<float>("confidence");
    ASSERT_TRUE(distance && confidence);
    const KdTree samples(cloud.positions);
    std::size_t trusted = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vec3f x = mesh.vertices[v] + Vec3f(mesh.origin - cloud.origin);
      const auto nearest = samples.nearest(x);
      ASSERT_NEAR((*distance)[v], std::sqrt(nearest->squared_distance), 0.3);
      ASSERT_GE((*confidence)[v], 0);
      ASSERT_LE((*confidence)[v], 1);
      trusted += (*confidence)[v] == 1;
      if (x.z > 0 && std::hypot(x.x, x.y) < 0.3f * kUnit) ASSERT_EQ((*confidence)[v], 0);
      if (x.z < 0.7f * kUnit) ASSERT_EQ((*confidence)[v], 1);
    }
    EXPECT_GT(trusted, mesh.vertices.size() / 2);
    options.fit.open = true;
    options.mesh.confidence.reset();
    EXPECT_NE(run(cloud, options).attributes.find("confidence"), nullptr) << "open";
    options.mesh.confidence = false;
    EXPECT_EQ(run(cloud, options).attributes.find("confidence"), nullptr) << "not wanted";
  }
}

TEST(Reconstruct, StraySamplesMakeNoSheets) {
  PointSet cloud = test::sphere(8000);
  cloud = test::joined(std::move(cloud), test::sphere(14), 0.4f, {3, 0, 0});  // a few samples over a large area
  ReconstructReport report;
  const MeshTopology topology = measure_topology(run(cloud, {}, &report));
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.genus(), 0);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].text.find("left out"), std::string::npos);
  ReconstructOptions all;
  all.mesh.components.kind = ComponentChoice::Kind::all;
  EXPECT_GT(measure_topology(run(cloud, all)).components, 1u);
}

TEST(Reconstruct, OneFarSampleOrManyDuplicatesDoNoHarm) {
  const PointSet clean = test::sphere(5000);
  const std::size_t triangles = run(clean).triangles.size();
  PointSet far = clean;
  far.positions.push_back({-4e6f, 5, 5});
  far.normals.push_back({1, 0, 0});
  PointSet repeated = clean;
  for (int copy = 0; copy < 9; ++copy) repeated = test::joined(std::move(repeated), clean, 1, {0, 0, 0});
  for (const PointSet& cloud : {far, repeated}) {
    ReconstructReport report;
    EXPECT_EQ(run(cloud, {}, &report).triangles.size(), triangles);
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].text.find("left out"), std::string::npos);
  }
}

TEST(Reconstruct, DoesNotDependOnTheUnit) {
  PointSet cloud = test::torus(8000);
  std::erase_if(cloud.positions, [](const Vec3f& p) { return p[0] > 0.9f; });  // open: the far field takes part
  cloud.normals.clear();
  const TriangleMesh one = run(cloud);
  for (const float unit : {0x1p-40f, 0x1p-10f, 0x1p20f, 0x1p50f}) {
    PointSet scaled = cloud;
    for (Vec3f& p : scaled.positions) p *= unit;
    ReconstructReport report;
    const TriangleMesh other = run(scaled, {}, &report);
    ASSERT_EQ(other.triangles, one.triangles) << unit;
    for (std::size_t i = 0; i < one.vertices.size(); ++i) ASSERT_EQ(other.vertices[i], one.vertices[i] * unit);
    EXPECT_NEAR(report.spacing, 0.04 * unit, 0.02 * unit);
  }
}

TEST(Reconstruct, MoreDepthThanSamplesIsNoHarm) {
  const PointSet cloud = test::sphere(5000);
  const std::size_t triangles = run(cloud).triangles.size();
  ReconstructOptions options;
  for (const int depth : {6, 9, 12}) {
    options.fit.depth = depth;
    ReconstructReport report;
    const TriangleMesh mesh = run(cloud, options, &report);
    EXPECT_LT(report.noise, 1e-5) << depth;
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), static_cast<double>(triangles),
                0.5 * static_cast<double>(triangles));
    EXPECT_EQ(measure_topology(mesh).euler, 2);
  }
}

TEST(Reconstruct, KeepsPartsThatHaveTheirSamples) {
  PointSet cloud = test::sphere(8000);
  cloud = test::joined(std::move(cloud), test::sphere(2000), 0.4f, {3, 0, 0});
  EXPECT_EQ(measure_topology(run(cloud)).components, 2u);
}

TEST(Reconstruct, SurveyCoordinatesLoseNothing) {
  PointSet cloud = test::sphere(4000), far = cloud;
  far.origin = {512345.678, 5403210.123, 300};
  const TriangleMesh here = run(cloud), there = run(far);
  EXPECT_EQ(there.origin, far.origin);
  ASSERT_EQ(here.vertices.size(), there.vertices.size());
  for (std::size_t i = 0; i < here.vertices.size(); ++i) ASSERT_LT(norm(here.vertices[i] - there.vertices[i]), 1e-5f);
}

TEST(Reconstruct, CarriesColours) {
  PointSet cloud = test::sphere(8000);
  for (const Vec3f& p : cloud.positions)
    cloud.colors.push_back(p[2] > 0 ? std::array<std::uint8_t, 3>{250, 10, 20}
                                    : std::array<std::uint8_t, 3>{0, 30, 200});
  const TriangleMesh mesh = run(cloud);
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (std::abs(mesh.vertices[i][2]) < 0.15f) continue;
    EXPECT_EQ(mesh.colors[i][0], mesh.vertices[i][2] > 0 ? 250 : 0);
  }
  ReconstructOptions plain;
  plain.mesh.carry_colors = false;
  EXPECT_TRUE(run(cloud, plain).colors.empty());
}

TEST(Reconstruct, FewerTrianglesOnDemand) {
  const PointSet cloud = test::torus(10000);
  ReconstructOptions options;
  options.mesh.triangles = 500;
  const TriangleMesh counted = run(cloud, options);
  EXPECT_LE(counted.triangles.size(), 500u);
  EXPECT_GE(counted.triangles.size(), 480u);
  EXPECT_EQ(measure_topology(counted).genus(), 1);
  options.mesh.triangles.reset();
  const TriangleMesh fine = run(cloud);
  std::size_t last = fine.triangles.size();
  for (const double error : {2e-3, 5e-3, 2e-2}) {
    options.mesh.mesh_error = error;
    const TriangleMesh coarse = run(cloud, options);
    EXPECT_LT(coarse.triangles.size(), last);
    last = coarse.triangles.size();
    Progress progress;
    const SurfaceDistance distance = measure_distance(coarse, fine, {.samples = 20000}, progress);
    EXPECT_LT(distance.to_reference.mean, 2 * error);
    EXPECT_GT(distance.to_reference.mean, 0.3 * error) << "more triangles than were asked for";
  }
}

TEST(Reconstruct, IsTheSameForAnyNumberOfThreads) {
  const PointSet cloud = test::torus(30000);
  test::compare_threads([&] { return run(cloud); },
                        [](const TriangleMesh& one, const TriangleMesh& many) {
                          ASSERT_EQ(one.vertices, many.vertices);
                          ASSERT_EQ(one.triangles, many.triangles);
                          ASSERT_EQ(one.normals, many.normals);
                        });
}

TEST(Reconstruct, StopsWhenCancelled) {
  Progress* running = nullptr;
  Progress progress([&](const std::string& stage, double) {
    if (stage == "march") running->cancel();
  });
  running = &progress;
  EXPECT_THROW(reconstruct(test::sphere(20000), {}, progress), Cancelled);
}

TEST(Reconstruct, RejectsOptionsOutOfRange) {
  const PointSet cloud = test::sphere(500);
  const auto rejects = [&](auto change) {
    ReconstructOptions options;
    change(options);
    EXPECT_THROW(run(cloud, options), ArgumentError);
  };
  rejects([](ReconstructOptions& o) { o.fit.depth = kLeastDepth - 1; });
  rejects([](ReconstructOptions& o) { o.fit.depth = kMostDepth + 1; });
  rejects([](ReconstructOptions& o) { o.fit.error = 0; });
  rejects([](ReconstructOptions& o) { o.fit.error = std::nan(""); });
  rejects([](ReconstructOptions& o) { o.fit.support = 1; });
  rejects([](ReconstructOptions& o) { o.fit.degree = 5; });
  rejects([](ReconstructOptions& o) { o.mesh.mesh_error = -1; });
  rejects([](ReconstructOptions& o) { o.mesh.triangles = 3; });
  rejects([](ReconstructOptions& o) { o.mesh.trim = -1; });
  rejects([](ReconstructOptions& o) { o.mesh.components = {ComponentChoice::Kind::count, 0}; });
}

TEST(Reconstruct, DepthsAreThoseOfThePartition) {
  const auto takes = [](const auto& options) {
    try {
      options.validate();
      return true;
    } catch (const ArgumentError&) {
      return false;
    }
  };
  for (int depth = 0; depth < 20; ++depth) {
    PartitionOptions partition;
    FitOptions fit;
    MeshOptions mesh;
    partition.max_depth = fit.depth = mesh.block_depth = depth;
    EXPECT_EQ(takes(partition), depth >= kLeastDepth && depth <= kMostDepth) << depth;
    EXPECT_EQ(takes(fit), takes(partition)) << depth;
    EXPECT_EQ(takes(mesh), takes(partition)) << depth;
  }
}

// Twisted blades: the other side is as near as neighbouring samples. Their vertices alone become sheets with dozens of
// handles.
TEST(Reconstruct, ThinClosedMeshesStayWhatTheyAre) {
  SANSMESH_NOT_SANITIZED("judges meshes; others reconstruct thin walls, too");
  for (const float thickness : {0.08f, 0.05f}) {  // 3 and 2 spacings
    PointSet mesh = test::ball_mesh(5);
    for (Vec3f& p : mesh.positions) {
      const float x = 0.4f * p.x, z = 0.5f * thickness * p.z, c = std::cos(0.8f * p.y), s = std::sin(0.8f * p.y);
      p = {c * x - s * z, p.y, s * x + c * z};
    }
    TriangleMesh truth;
    truth.vertices = mesh.positions;
    truth.triangles = mesh.triangles;
    ReconstructReport report;
    const TriangleMesh result = run(mesh, {}, &report);
    const MeshTopology topology = measure_topology(result);
    EXPECT_TRUE(topology.closed()) << thickness;
    EXPECT_EQ(topology.components, 1u) << thickness;
    EXPECT_EQ(topology.genus(), 0) << thickness;
    Progress progress;
    DistanceOptions few;
    few.samples = 20000;
    const SurfaceDistance off = measure_distance(result, truth, few, progress);
    EXPECT_LT(off.to_reference.rms, 0.05 * static_cast<double>(thickness)) << thickness;
    EXPECT_LT(off.from_reference.rms, 0.05 * static_cast<double>(thickness)) << thickness;
  }
}

// A cluster of a few samples may be stray; vertices of faces are not.
TEST(Reconstruct, SmallSolidsOfMeshesStay) {
  const PointSet mesh = test::joined_meshes(test::ball_mesh(5), test::ball_mesh(1), 0.06f, {1.5f, 0.2f, 0});
  ReconstructReport report;
  EXPECT_EQ(measure_topology(run(mesh, {}, &report)).components, 2u);
  EXPECT_EQ(report.lost, 0);
  EXPECT_TRUE(report.notes.empty());

  PointSet cloud = mesh;
  cloud.triangles.clear();
  EXPECT_EQ(measure_topology(run(cloud)).components, 1u);
  PointSet stray = mesh;  // vertices without a face make it a cloud again
  stray.positions.push_back({1.2f, 0.2f, 0});
  EXPECT_EQ(measure_topology(run(stray)).components, 1u);
}

TEST(Reconstruct, EstimatesNormalsThatAreUnrelated) {
  PointSet cloud = test::sphere(4000);
  std::mt19937 random(4);
  std::normal_distribution<float> gauss;
  for (Vec3f& n : cloud.normals) n = normalized(Vec3f{gauss(random), gauss(random), gauss(random)});
  ReconstructReport report;
  const TriangleMesh mesh = run(cloud, {}, &report);
  EXPECT_TRUE(report.estimated_normals);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].code, "unrelated_normals");
  for (const Vec3f& v : mesh.vertices) ASSERT_NEAR(norm(mesh.origin + Vec3(v)), 1, 0.005);
}

TEST(Reconstruct, SmallPartsOfManySamplesStay) {
  PointSet cloud = test::sphere(20000);
  for (int i = 0; i < 5; ++i)
    cloud = test::joined(std::move(cloud), test::sphere(60), 0.06f, {1.5f, 0, 0.4f * static_cast<float>(i)});
  ReconstructReport report;
  EXPECT_EQ(measure_topology(run(cloud, {}, &report)).components, 6u);
  EXPECT_EQ(report.lost, 0);
}

TEST(Reconstruct, RejectsCloudsWithoutArea) {
  PointSet cloud;
  EXPECT_THROW(run(cloud), DataError);
  cloud.positions.assign(8, {1, 2, 3});
  EXPECT_THROW(run(cloud), DataError);
  cloud.positions.assign(100, {1, 2, 3});
  EXPECT_THROW(run(cloud), DataError);
  for (std::size_t i = 0; i < 100; ++i) cloud.positions[i] = Vec3f{1, 2, 3} * static_cast<float>(i);
  EXPECT_THROW(run(cloud), DataError);
}

TEST(Reconstruct, PlanesAreOpenSheets) {
  const auto expect_sheets = [](const PointSet& cloud, double spacing, std::size_t count) {
    ReconstructReport report;
    const TriangleMesh mesh = run(cloud, {}, &report);
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(topology.components, count) << cloud.size();
    EXPECT_EQ(topology.genus(), 0);
    EXPECT_FALSE(topology.closed());
    EXPECT_EQ(report.lost, 0);
    for (const Vec3f& x : mesh.vertices) ASSERT_NEAR(x.z, 5, 1.1 * spacing);  // only at the border
  };
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(0, 1);
  for (const std::size_t n : {20u, 40u, 60u, 1000u}) {
    PointSet cloud;
    for (std::size_t i = 0; i < n; ++i) cloud.positions.push_back({u(random), u(random), 5});
    const double spacing = 1 / std::sqrt(static_cast<double>(n));
    expect_sheets(cloud, spacing, 1);
    cloud.normals.assign(n, {0, 0, -1});
    expect_sheets(cloud, spacing, 1);
  }
  PointSet lattice;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) lattice.positions.push_back({static_cast<float>(i), static_cast<float>(j), 5});
  expect_sheets(lattice, 1, 1);
  // The only fit has its foot between the two.
  for (std::size_t i = 200; i < 400; ++i) lattice.positions[i].x += 20;
  expect_sheets(lattice, 1, 2);
}

TEST(Reconstruct, PlanesBesideFineShapesStay) {
  // Few fits for four coplanar tiles, and many for a ball.
  PointSet cloud = test::joined(test::cube(100), test::sphere(20000), 10, {5, 5, 20});
  cloud.positions.erase(cloud.positions.begin(), cloud.positions.begin() + 100);
  cloud.normals.clear();
  for (const float x : {-40.0f, 0.0f})
    for (const float y : {-40.0f, 0.0f})
      for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j)
          cloud.positions.push_back({x + static_cast<float>(i), y + static_cast<float>(j), 0});
  ReconstructReport report;
  EXPECT_EQ(measure_topology(run(cloud, {}, &report)).components, 5u);
  EXPECT_EQ(report.lost, 0);
}

TEST(MeshFunction, WritesItsReportAnew) {
  PointSet cloud = test::sphere(3000);
  const PointSet sparse = test::sphere(40);
  for (std::size_t i = 0; i < sparse.size(); ++i) {  // left out, with a warning
    cloud.positions.push_back(sparse.positions[i] * 0.7f + Vec3f{3, 0, 0});
    cloud.normals.push_back(sparse.normals[i]);
  }
  Progress progress;
  const FittedFunction two = fit_surface_function(cloud, {}, progress),
                       one = fit_surface_function(test::sphere(3000), {}, progress);
  MeshOptions measured;
  measured.measure_quality = true;
  MeshReport used, fresh;
  mesh_function(two, measured, progress, &used);
  EXPECT_FALSE(used.notes.empty());
  mesh_function(one, {}, progress, &used);
  mesh_function(one, {}, progress, &fresh);
  EXPECT_EQ(used.notes, fresh.notes);
  EXPECT_EQ(used.aspect_mean_before, fresh.aspect_mean_before);
  EXPECT_EQ(used.components, fresh.components);
  EXPECT_EQ(used.blocks, fresh.blocks);
  EXPECT_EQ(used.block_depth, fresh.block_depth);
  // Except for the values that reconstruct adds.
  for (int round = 0; round < 2; ++round) {
    const ReconstructResult made = reconstruct(cloud, {}, progress);
    const ReconstructReport& whole = made.report;
    ASSERT_EQ(made.notes.size(), 2u);
    EXPECT_EQ(made.notes[0].code, "parts_left_out");
    EXPECT_EQ(made.notes[1].code, "lost_samples");
    EXPECT_EQ(made.notes[0].remedy, "`components = all` keeps them");
    EXPECT_EQ(whole.fits, two.field.report().functions);
    EXPECT_EQ(whole.fit_depth, two.field.report().depth);
    EXPECT_GT(whole.spacing, 0);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
