// Every registered surface, from samples to mesh.
#include "sansmesh/model/surface_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/reconstruct.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/sanitizers.h"
#include "support/surface_names.h"

namespace sansmesh::inline v1 {
namespace {

SurfaceModel model_of(const PointSet& cloud, const SurfaceOptions& options) {
  Progress progress;
  return make_surface_model(cloud, options, progress);
}

TriangleMesh mesh_of(const PointSet& cloud, const SurfaceOptions& surface, ReconstructReport* report = nullptr) {
  ReconstructOptions options;
  options.surface = surface;
  Progress progress;
  ReconstructResult made = reconstruct(cloud, options, progress);
  if (report) *report = made.report;
  return std::move(made.mesh);
}

SurfaceOptions named(const std::string& method) {
  SurfaceOptions options;
  options.method = method;
  if (method == "amls") options.order = 4, options.iterations = 3;  // cross validation is slow
  return options;
}

double to_torus(const Vec3& p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.35; }

/// Mean and largest |distance(vertex)|.
struct Off {
  double mean = 0, largest = 0;
};
Off off(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& distance) {
  Off result;
  for (const Vec3f& v : mesh.vertices) {
    const double d = std::abs(distance(mesh.origin + Vec3(v)));
    result.mean += d / static_cast<double>(mesh.vertices.size());
    result.largest = std::max(result.largest, d);
  }
  return result;
}

/// One half of the sphere.
PointSet bowl(std::size_t n) {
  const PointSet ball = test::sphere(2 * n);
  PointSet half;
  for (std::size_t i = 0; i < ball.size(); ++i) {
    if (ball.positions[i].x < 0) continue;
    half.positions.push_back(ball.positions[i]);
    half.normals.push_back(ball.normals[i]);
  }
  return half;
}

class EverySurface : public testing::TestWithParam<std::string> {
 protected:
  /// Steps at the borders between the samples' cells.
  bool rough() const { return GetParam() == "hoppe"; }
  /// Means of planes deviate by the curvature of the surface within their width, which is large in dey's method.
  bool of_planes() const { return GetParam() == "adamson" || GetParam() == "kolluri" || GetParam() == "extremal"; }
  /// The target error of partition meshes is 0.037 spacings (default_mesh_error), that of the others the error of the
  /// surface.
  bool simplified() const { return GetParam() == "partition"; }
  /// Its steps to the surface are not Newton's where the mean of the planes takes over.
  bool steps_far() const { return GetParam() == "extremal"; }
  double accuracy() const { return GetParam() == "dey" ? 0.15 : of_planes() ? 0.05 : simplified() ? 0.04 : 0.025; }
};

TEST_P(EverySurface, OfASphereIsClosedAndClose) {
  const PointSet cloud = test::sphere(2000);
  ReconstructReport report;
  const TriangleMesh mesh = mesh_of(cloud, named(GetParam()), &report);
  const double spacing = std::sqrt(4 * std::numbers::pi / 2000);
  EXPECT_NEAR(report.spacing, spacing, 0.1 * spacing);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.euler, 2);
  const Off error = off(mesh, [](const Vec3& p) { return norm(p) - 1; });
  EXPECT_LT(error.mean, accuracy() * spacing);
  EXPECT_LT(error.largest, (steps_far() ? 4 : 2) * accuracy() * spacing + 0.05 * spacing);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  double turned = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    turned += 1 - dot(Vec3(mesh.normals[i]), normalized(Vec3(mesh.vertices[i])));
  EXPECT_LT(turned / static_cast<double>(mesh.vertices.size()), 2e-3);
}

TEST_P(EverySurface, OfATorusAtRandomPlacesIsClosedAndClose) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others mesh every surface");
  const PointSet cloud = test::torus(4000);
  ReconstructReport report;
  const TriangleMesh mesh = mesh_of(cloud, named(GetParam()), &report);
  const double spacing = 2 * std::numbers::pi * std::sqrt(0.35 / 4000);
  const MeshTopology topology = measure_topology(mesh);
  if (!rough()) {
    EXPECT_TRUE(topology.closed()) << topology.boundary_loops << " holes";
    EXPECT_EQ(topology.genus(), 1);
  }
  EXPECT_EQ(topology.components, 1u);
  const Off error = off(mesh, to_torus);
  EXPECT_LT(error.mean, (rough() ? 0.1 : 0.035 + accuracy()) * spacing);
  EXPECT_LT(error.largest, (rough() || steps_far() ? 0.8 : 0.5) * spacing);
}

TEST_P(EverySurface, EndsWhereTheSamplesEnd) {
  const PointSet cloud = bowl(1200);
  ReconstructReport report;
  const TriangleMesh mesh = mesh_of(cloud, named(GetParam()), &report);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_EQ(topology.euler, 1) << "a disc";
  const double reach = 3 * report.spacing;
  float least = 1;
  for (const Vec3f& v : mesh.vertices) least = std::min(least, v.x);
  EXPECT_GT(least, -reach);
  EXPECT_LT(least, 0.5 * report.spacing) << "all of it is there";
}

TEST_P(EverySurface, DoesNotDependOnPlaceAndUnit) {
  SANSMESH_NOT_SANITIZED("repeats what others run");
  const PointSet cloud = test::sphere(600, 0.003);
  const TriangleMesh one = mesh_of(cloud, named(GetParam()));
  const double edge = 2.0;
  for (const float unit : {1000.0f, 1024.0f}) {
    PointSet moved = cloud;
    for (Vec3f& p : moved.positions) p *= unit;
    moved.origin = {1e6, -1e6, 3e6};
    ReconstructReport report;
    const TriangleMesh other = mesh_of(moved, named(GetParam()), &report);
    // Powers of two change nothing; other factors change the size of the blocks by up to a fifth.
    if (unit == 1024) {
      ASSERT_EQ(other.triangles, one.triangles);
    } else {
      EXPECT_NEAR(static_cast<double>(other.vertices.size()), static_cast<double>(one.vertices.size()),
                  0.1 * static_cast<double>(one.vertices.size()));
    }
    EXPECT_TRUE(measure_topology(other).closed());
    double worst = 0;
    for (const Vec3f& v : other.vertices)
      worst = std::max(worst, std::abs(norm((other.origin + Vec3(v) - moved.origin) / static_cast<double>(unit)) - 1));
    EXPECT_LT(worst, (steps_far() ? 0.04 : 0.022) * edge) << unit;
    if (unit == 1024) {
      for (std::size_t i = 0; i < one.vertices.size(); ++i) {
        const Vec3 there = (other.origin - moved.origin + Vec3(other.vertices[i])) / static_cast<double>(unit);
        ASSERT_LT(norm(there - one.origin - Vec3(one.vertices[i])), 1e-5);
      }
    }
    EXPECT_NEAR(report.spacing / static_cast<double>(unit), std::sqrt(4 * std::numbers::pi / 600), 0.02);
  }
}

TEST_P(EverySurface, IsAFieldInCoordinatesOfItsOwn) {
  PointSet cloud = test::sphere(3000);
  for (Vec3f& p : cloud.positions) p = p * 200.0f;
  cloud.origin = {5e5, 4e6, 300};
  const SurfaceModel model = model_of(cloud, named(GetParam()));
  EXPECT_EQ(model.report().method, GetParam());
  EXPECT_EQ(model.report().samples, cloud.size());
  EXPECT_EQ(model.projection() != nullptr, surface_method(GetParam()).projects);
  EXPECT_EQ(model.normals(), nullptr);
  Progress progress;
  EXPECT_EQ(model.placement(progress), nullptr);
  EXPECT_EQ(model.colors(), nullptr);
  EXPECT_FALSE(model.seeds().empty());
  EXPECT_GT(model.blocks(1).leaves().size(), model.blocks(4).leaves().size());
  const auto& balls = model.balls();
  ASSERT_EQ(balls.centers.size(), balls.radii.size());
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < 400; ++i) {
    const Vec3 d = normalized(Vec3(cloud.positions[7 * i]));
    for (const double r : {0.99, 1.01}) x.push_back(model.frame().from_input(cloud.origin + d * (200 * r)));
  }
  std::vector<double> values(x.size());
  std::vector<Vec3> gradients(x.size());
  std::vector<std::uint8_t> inside(x.size());
  model.field(progress).evaluate_in_domain(x, values, gradients, inside);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_TRUE(inside[i]);
    ASSERT_EQ(values[i] > 0, i % 2 == 1) << "positive outside";
    ASSERT_GT(dot(gradients[i], x[i] - model.frame().from_input(cloud.origin)), 0);
    bool held = false;
    for (std::size_t b = 0; b < balls.centers.size() && !held; ++b)
      held = norm(Vec3(balls.centers[b]) - x[i]) <= static_cast<double>(balls.radii[b]);
    ASSERT_TRUE(held) << "the balls hold what is near the surface";
  }
}

INSTANTIATE_TEST_SUITE_P(Names, EverySurface, testing::ValuesIn(test::surface_names()),
                         [](const auto& tested) { return tested.param; });

TEST(SurfaceModel, TakesNoiseAway) {
  const std::size_t n = 3000;
  const double spacing = std::sqrt(4 * std::numbers::pi / n), noise = 0.3 * spacing;
  const PointSet cloud = test::sphere(n, noise);
  for (const char* method : {"apss", "kolluri", "curvature"}) {
    ReconstructReport report;
    const TriangleMesh mesh = mesh_of(cloud, named(method), &report);
    EXPECT_TRUE(measure_topology(mesh).closed()) << method;
    EXPECT_LT(off(mesh, [](const Vec3& p) { return norm(p) - 1; }).mean, 0.45 * noise) << method;
    EXPECT_NEAR(report.noise, noise, 0.4 * noise) << method;
  }
}

TEST(SurfaceModel, MpuClosesWideHolesUnlessItIsTrimmed) {
  const PointSet ball = test::sphere(4000);
  PointSet cut;
  for (std::size_t i = 0; i < ball.size(); ++i) {
    if (ball.positions[i].z > 0.8f) continue;
    cut.positions.push_back(ball.positions[i]);
    cut.normals.push_back(ball.normals[i]);
  }
  ReconstructOptions options;
  options.surface = named("mpu");
  options.fit.open = false;
  Progress progress;
  const TriangleMesh closed = reconstruct(cut, options, progress).mesh;
  EXPECT_TRUE(measure_topology(closed).closed());
  EXPECT_EQ(measure_topology(closed).euler, 2);
  options.mesh.trim = 0.2;
  const MeshTopology trimmed = measure_topology(reconstruct(cut, options, progress).mesh);
  EXPECT_EQ(trimmed.boundary_loops, 1u);
  EXPECT_EQ(trimmed.components, 1u);
}

/// Pictures and resampling search the surface in these balls: also in holes of flat faces, whose cells are large and
/// contain samples, and at their rims.
TEST(SurfaceModel, BallsOfMpuHoldItsSurfaceOverHoles) {
  const PointSet cloud = test::cube(8000);
  for (const double hole : {0.2, 0.35, 0.6}) {
    PointSet cut;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Vec3f& p = cloud.positions[i];
      if (p.z > 0.999f && std::hypot(static_cast<double>(p.x), static_cast<double>(p.y)) < hole) continue;
      cut.positions.push_back(p), cut.normals.push_back(cloud.normals[i]);
    }
    Progress progress;
    const SurfaceModel model = make_surface_model(cut, named("mpu"), progress);
    const BallUnion& balls = model.balls();
    for (double x = -0.7; x <= 0.7; x += 0.05)
      for (double y = -0.7; y <= 0.7; y += 0.05) {
        const Vec3 at = model.frame().from_input(Vec3{x, y, 1});
        bool held = false;
        for (std::size_t i = 0; i < balls.centers.size() && !held; ++i)
          held = norm(Vec3(balls.centers[i]) - at) < static_cast<double>(balls.radii[i]);
        EXPECT_TRUE(held) << hole << ": " << x << ", " << y;
      }
  }
}

TEST(SurfaceModel, MpuHeedsOptionsOfTheFit) {
  const PointSet cloud = test::cube(4000);
  const auto mesh_with = [&](auto change) {
    ReconstructOptions options;
    options.surface = named("mpu");
    change(options);
    Progress progress;
    return reconstruct(cloud, options, progress).mesh;
  };
  const auto same = [](const TriangleMesh& a, const TriangleMesh& b) { return a.vertices == b.vertices; };
  const TriangleMesh plain = mesh_with([](ReconstructOptions&) {});
  const TriangleMesh coarse = mesh_with([](ReconstructOptions& o) { o.fit.error = 0.05; });
  const TriangleMesh smooth = mesh_with([](ReconstructOptions& o) { o.fit.sharp = false; });
  const TriangleMesh shallow = mesh_with([](ReconstructOptions& o) { o.fit.depth = 2; });
  for (const TriangleMesh* m : {&coarse, &smooth, &shallow}) EXPECT_FALSE(same(plain, *m));
  EXPECT_TRUE(same(coarse, mesh_with([](ReconstructOptions& o) { o.surface.error = 0.05; })));
  EXPECT_TRUE(same(smooth, mesh_with([](ReconstructOptions& o) { o.surface.smooth = true; })));
  EXPECT_TRUE(same(shallow, mesh_with([](ReconstructOptions& o) { o.surface.depth = 2; })));
  EXPECT_THROW(mesh_with([](ReconstructOptions& o) { o.fit.degree = 2; }), ArgumentError);
  EXPECT_THROW(mesh_with([](ReconstructOptions& o) { o.surface.error = -1; }), ArgumentError);
}

TEST(SurfaceModel, HasTheColoursOfTheSamples) {
  PointSet cloud = test::sphere(3000);
  for (const Vec3f& p : cloud.positions)
    cloud.colors.push_back(
        {static_cast<std::uint8_t>(127.5f + 127 * p.x), 10, static_cast<std::uint8_t>(p.z > 0 ? 200 : 50)});
  for (const char* method : {"apss", "curvature", "partition"}) {
    const SurfaceModel model = model_of(cloud, named(method));
    ASSERT_NE(model.colors(), nullptr) << method;
    std::vector<Vec3> x;
    for (const Vec3f& p : cloud.positions)
      if (std::abs(p.z) > 0.2f) x.push_back(model.frame().from_input(Vec3(p)));
    std::vector<Vec3f> colors(x.size());
    model.colors()->evaluate(x, colors);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 p = model.frame().to_input(x[i]);
      ASSERT_NEAR(colors[i].x, (127.5 + 127 * p.x) / 255, 0.03);
      ASSERT_NEAR(colors[i].z, (p.z > 0 ? 200 : 50) / 255.0, 0.01);
    }
    const TriangleMesh mesh = mesh_of(cloud, named(method));
    ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      ASSERT_NEAR(mesh.colors[i][0], 127.5f + 127 * mesh.vertices[i].x, 12) << method;
    ReconstructOptions plain;
    plain.surface = named(method);
    plain.mesh.carry_colors = false;
    Progress progress;
    EXPECT_TRUE(reconstruct(cloud, plain, progress).mesh.colors.empty());
  }
}

TEST(SurfaceModel, OptionsMeanWhatTheySay) {
  const PointSet cloud = test::sphere(3000);
  SurfaceOptions wide = named("apss"), same = wide;
  wide.smoothing = 3;
  const SurfaceModel w = model_of(cloud, wide), plain = model_of(cloud, same);
  EXPECT_NEAR(w.report().smoothing, 3, 1e-6);
  EXPECT_GT(plain.report().smoothing, 0.5);
  EXPECT_LT(plain.report().smoothing, 3);
  // The width is a length of the input, independent of the unit of the model.
  PointSet large = cloud;
  for (Vec3f& p : large.positions) p *= 5000.0f;
  same.bandwidth = 5000 * 0.15;
  const SurfaceModel by_width = model_of(large, same);
  EXPECT_NEAR(by_width.report().smoothing * by_width.report().spacing, 5000 * 0.15, 5000 * 0.01);
  SurfaceOptions amls = named("amls");
  amls.order = 2, amls.iterations = 5;
  const SurfaceModel a = model_of(cloud, amls);
  EXPECT_EQ(a.report().order, 2);
  EXPECT_EQ(a.report().iterations, 5);
  SurfaceOptions sharp = named("curvature");
  sharp.sharp = SharpFormula::bilateral;
  const SurfaceModel s = model_of(cloud, sharp);
  EXPECT_NE(s.normals(), nullptr);
  Progress progress;
  EXPECT_NE(s.placement(progress), nullptr);
}

TEST(SurfaceModel, IsTheSameForAnyNumberOfThreads) {
  const PointSet cloud = test::torus(1500);
  for (const char* method : {"apss", "curvature"}) {
    SurfaceOptions options = named(method);
    options.sharp = SharpFormula::bilateral;
    test::compare_threads([&] { return mesh_of(cloud, options); },
                          [&](const TriangleMesh& one, const TriangleMesh& many) {
                            EXPECT_EQ(one.vertices, many.vertices) << method;
                            EXPECT_EQ(one.triangles, many.triangles) << method;
                          });
  }
}

TEST(SurfaceModel, MakesTheFieldOfAProjectionWhereItCanBeSeenAndStopped) {
  const PointSet cloud = test::sphere(2000);
  const SurfaceModel model = model_of(cloud, named("alexa"));
  Progress* watched = nullptr;
  Progress stopped([&](const std::string&, double) { watched->cancel(); });
  watched = &stopped;
  EXPECT_THROW(model.field(stopped), Cancelled);
  EXPECT_THROW(model.placement(stopped), Cancelled);
  // A cancelled field leaves no state: the next call makes it, and only once.
  Progress seen;
  const ScalarField& field = model.field(seen);
  const std::size_t stages = seen.timings().size();
  EXPECT_GT(stages, 0u);
  EXPECT_EQ(&model.field(seen), &field);
  EXPECT_EQ(seen.timings().size(), stages);
  const SurfaceModel other = model_of(cloud, named("alexa"));
  Progress progress;
  std::vector<Vec3> x;
  for (const Vec3f& p : cloud.positions) x.push_back(model.frame().from_input(Vec3(p) * 1.3));
  std::vector<double> a(x.size()), b(x.size());
  field.evaluate(x, a);
  other.field(progress).evaluate(x, b);
  EXPECT_EQ(a, b);
}

TEST(SurfaceModel, KnownNoiseAndSpacingAreWhatWouldBeEstimated) {
  SANSMESH_NOT_SANITIZED("compares results; others make the same models");
  PointSet given = test::torus(3000);
  for (std::size_t i = 0; i < given.size(); ++i)
    given.positions[i] += given.normals[i] * (0.006f * static_cast<float>(static_cast<int>(i % 5) - 2));
  PointSet none = given, mixed = given;
  none.normals.clear();
  for (std::size_t i = 0; i < mixed.size(); ++i)
    if (mixed.positions[i].x > 0.2f) mixed.normals[i] = -mixed.normals[i];
  for (const PointSet& cloud : {given, none, mixed})
    for (const char* method : {"apss", "curvature"}) {
      SurfaceOptions options = named(method);
      options.sharp = SharpFormula::bilateral;
      Progress progress;
      const PreparedCloud known = prepare_cloud(cloud, {}, progress);
      PreparedCloud unknown = known;
      ASSERT_TRUE(known.noise);
      EXPECT_EQ(*known.noise, estimate_noise(known.points));
      EXPECT_TRUE(!known.spacing || *known.spacing == estimate_spacing(known.points));
      unknown.noise = unknown.spacing = std::nullopt;
      const SurfaceModel a = make_surface_model(known, options, progress),
                         b = make_surface_model(std::move(unknown), options, progress);
      EXPECT_EQ(a.report().noise, b.report().noise);
      EXPECT_EQ(a.report().smoothing, b.report().smoothing);
      EXPECT_EQ(a.points().normals, b.points().normals);
      std::vector<Vec3> x(a.points().positions.begin(), a.points().positions.end());
      std::vector<double> va(x.size()), vb(x.size());
      a.field(progress).evaluate(x, va);
      b.field(progress).evaluate(x, vb);
      EXPECT_EQ(va, vb) << method;
    }
}

TEST(SurfaceModel, RefusesOptionsOfOtherMethods) {
  const auto refused = [](auto change, const std::string& method, const std::string& part) {
    SurfaceOptions options;
    options.method = method;
    change(options);
    try {
      options.validate();
      ADD_FAILURE() << method << ": accepted, expected … " << part;
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
    EXPECT_THROW(model_of(test::sphere(500), options), ArgumentError);
    EXPECT_THROW(mesh_of(test::sphere(500), options), ArgumentError);
  };
  refused([](SurfaceOptions& o) { o.smoothing = 2; }, "partition", "smoothing");
  refused([](SurfaceOptions& o) { o.bandwidth = 2; }, "partition", "`bandwidth` means nothing");
  refused([](SurfaceOptions& o) { o.sharp = SharpFormula::laguerre; }, "partition",
          "its supports and its creases follow the data");
  refused([](SurfaceOptions& o) { o.separate_sheets = false; }, "hoppe", "`separate_sheets` belongs to adamson, ");
  refused([](SurfaceOptions& o) { o.order = 2; }, "apss", "`order` belongs to amls, not to the surface apss");
  refused([](SurfaceOptions& o) { o.iterations = 2; }, "levin", "`iterations` belongs to amls");
  refused([](SurfaceOptions& o) { o.order = 3; }, "amls", "order");
  refused([](SurfaceOptions& o) { o.iterations = -1; }, "amls", "iterations");
  refused([](SurfaceOptions& o) { o.diffusion = SurfaceOptions::Diffusion::soft; }, "alexa", "diffusion");
  refused([](SurfaceOptions& o) { o.method = "poisson"; }, "apss", "partition, hoppe, ");
  refused([](SurfaceOptions& o) { o.smoothing = 0.1; }, "apss", "smoothing");
  refused([](SurfaceOptions& o) { o.smoothing = 50; }, "curvature", "smoothing");
  refused([](SurfaceOptions& o) { o.smoothing = std::nan(""); }, "kolluri", "smoothing");
  refused([](SurfaceOptions& o) { o.bandwidth = -1; }, "apss", "bandwidth");
}

TEST(SurfaceModel, RefusesCloudsWithoutASurface) {
  PointSet line, none, same;
  for (int i = 0; i < 400; ++i) line.positions.push_back({static_cast<float>(i), 3, 2});
  same.positions.assign(50, {1, 2, 3});
  for (const std::string& method : test::surface_names())
    for (const PointSet* cloud : {&line, &none, &same})
      EXPECT_THROW(model_of(*cloud, named(method)), DataError) << method << ", " << cloud->size() << " points";
  // Few samples give a surface or a clear error.
  for (const std::string& method : test::surface_names())
    for (const std::size_t n : {9u, 20u, 60u}) {
      try {
        const TriangleMesh mesh = mesh_of(test::sphere(n), named(method));
        for (const Vec3f& v : mesh.vertices) ASSERT_TRUE(is_finite(v));
      } catch (const DataError& error) {
        EXPECT_FALSE(std::string(error.what()).empty());
      }
    }
}

}  // namespace
}  // namespace sansmesh::inline v1
