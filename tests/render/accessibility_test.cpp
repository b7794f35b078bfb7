// Accessibility shading.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "render/analytic_surfaces.h"
#include "sansmesh/error.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/splat/blended_splats.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "sansmesh/render_options.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kWidth = 81;

RenderOptions open_light(double reach, double curvature = 0) {
  RenderOptions options;
  options.view.width = options.view.height = kWidth;
  options.view.orthographic = true;
  options.view.direction = {0, 90};
  options.look.ground = false;
  options.look.background = Background::transparent();
  options.look.accessibility = reach;
  options.look.curvature_shading = curvature;
  return options;
}

/// Light of a pixel relative to the surface's own colour.
double light_at(const Image& image, const RenderOptions& options, int x, int y) {
  const Rgba& p = image.at(x, y);
  return static_cast<double>(linear_color({p[0], p[1], p[2]}).x / linear_color(options.look.surface_color).x);
}

/// The part of the unit sphere up to an angle from its lowest point, seen from inside.
TriangleMesh bowl(double angle) {
  TriangleMesh mesh;
  constexpr std::uint32_t kRings = 48, kAround = 96;
  mesh.vertices.push_back({0, -1, 0});
  for (std::uint32_t j = 1; j <= kRings; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const double a = angle * j / kRings, u = 2 * std::numbers::pi * i / kAround;
      mesh.vertices.push_back(Vec3f(Vec3{std::sin(a) * std::cos(u), -std::cos(a), std::sin(a) * std::sin(u)}));
    }
  const auto at = [](std::uint32_t j, std::uint32_t i) { return 1 + (j - 1) * kAround + i % kAround; };
  for (std::uint32_t i = 0; i < kAround; ++i) mesh.triangles.push_back({0, at(1, i), at(1, i + 1)});
  for (std::uint32_t j = 1; j < kRings; ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
  return mesh;
}

TEST(Accessibility, APlaneIsOpenEverywhere) {
  TriangleMesh plane;
  plane.vertices = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  plane.triangles = {{0, 2, 1}, {0, 3, 2}};
  const RenderOptions options = open_light(10);
  Progress progress;
  const Image image = render_mesh(plane, options, progress);
  for (int k = 20; k < 60; ++k) EXPECT_NEAR(light_at(image, options, k, 2 * k - 40 > 60 ? 60 : 40), 1, 1e-5);
}

TEST(Accessibility, TheBottomOfABowlSeesWhatItsRimLeaves) {
  // Seen from the lowest point the rim is at 90° − angle/2 from the zenith.
  Progress progress;
  for (const double degrees : {60.0, 90.0, 120.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const RenderOptions options = open_light(10);
    const Image image = render_mesh(bowl(angle), options, progress);
    EXPECT_NEAR(light_at(image, options, kWidth / 2, kWidth / 2), std::pow(std::cos(angle / 2), 2), 0.02) << degrees;
  }
}

TEST(Accessibility, WhatIsBeyondItsReachHidesNothing) {
  // Chords of the unit sphere from its lowest point have length 2 cos ψ, ψ from the zenith: rays with shorter ones than
  // the reach are occluded.
  const TriangleMesh half = bowl(std::numbers::pi / 2);
  const double diagonal = 3;  // diagonal of the box 2 × 1 × 2
  Progress progress;
  for (const double length : {0.4, 0.8, 1.2}) {
    const RenderOptions options = open_light(length / diagonal);
    const Image image = render_mesh(half, options, progress);
    EXPECT_NEAR(light_at(image, options, kWidth / 2, kWidth / 2), 1 - length * length / 4, 0.02) << length;
  }
}

TEST(Accessibility, TheMiddleOfAGrooveSeesWhatItsWallsLeave) {
  // A long channel of width one: at the middle of its floor, walls of height h leave ½ / √(¼ + h²) (two-dimensional
  // view).
  Progress progress;
  for (const float h : {0.3f, 0.5f, 1.0f}) {
    TriangleMesh groove;
    constexpr float kLong = 20, kHalf = 0.5f;
    for (const auto& [x, y] : {std::pair{-kHalf, h}, {-kHalf, 0.0f}, {kHalf, 0.0f}, {kHalf, h}})
      for (const float z : {-kLong, kLong}) groove.vertices.push_back({x, y, z});
    for (std::uint32_t k = 0; k < 6; k += 2) {
      groove.triangles.push_back({k, k + 1, k + 3});
      groove.triangles.push_back({k, k + 3, k + 2});
    }
    RenderOptions options = open_light(1);
    options.view.look_at = Vec3{0, 0, 0};
    options.view.look_radius = 0.45;
    const Image image = render_mesh(groove, options, progress);
    const double expected = 0.5 / std::hypot(0.5, static_cast<double>(h));
    EXPECT_NEAR(light_at(image, options, kWidth / 2, kWidth / 2), expected, 0.02) << h;
  }
}

constexpr double kSecondPlace = 1.2, kSecondRadius = 0.6;
/// Direction on the unit sphere towards both the other sphere and the viewer, (1, 0, 1).
const Vec3 kSeen{std::numbers::sqrt2 / 2, 0, std::numbers::sqrt2 / 2};
const Vec3 kSecond = kSeen + Vec3{kSecondPlace, 0, 0};

/// Distance to the unit sphere and to another one beside it.
class TwoSpheres final : public ScalarField {
 public:
  Box3 bounds() const override { return {{-2, -2, -2}, {4, 2, 3}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double one = norm(x[i]) - 1, other = norm(x[i] - kSecond) - kSecondRadius;
      values[i] = std::min(one, other);
      if (!gradients.empty()) gradients[i] = normalized(one < other ? x[i] : x[i] - kSecond);
    }
  }
};

TEST(Accessibility, ABallBesideHidesTheSquareOfItsAngle) {
  // A ball of radius r at distance d, above the horizon and 45° from the normal, occludes cos 45° (r / d)² of the
  // weighted hemisphere, for every kind of surface.
  const double expected = 1 - std::numbers::sqrt2 / 2 * std::pow(kSecondRadius / kSecondPlace, 2);
  BallUnion balls = test::sphere_balls(8000);
  const BallUnion second = test::sphere_balls(4000, kSecondRadius);
  PointSet cloud;
  cloud.positions = cloud.normals = balls.centers;
  for (const Vec3f& p : second.centers) {
    cloud.positions.push_back(Vec3f(Vec3(p) + kSecond));
    cloud.normals.push_back(normalized(p));
  }
  balls.centers = cloud.positions;
  balls.radii.insert(balls.radii.end(), second.radii.begin(), second.radii.end());

  SurfaceRenderOptions options;
  options.picture = open_light(10);
  options.picture.view.direction = {0, 0};
  options.picture.view.look_at = kSeen;
  options.picture.view.look_radius = 0.05;
  Progress progress;
  const TwoSpheres spheres;
  const SurfaceCaster caster(spheres, balls, {});
  const auto light = [&](const Image& image) { return light_at(image, options.picture, kWidth / 2, kWidth / 2); };
  EXPECT_NEAR(light(render_surface(caster, balls.centers, nullptr, options, progress)), expected, 0.02) << "discs";
  options.exact_shadows = true;
  EXPECT_NEAR(light(render_surface(caster, balls.centers, nullptr, options, progress)), expected, 0.01) << "exact";
  options.exact_shadows = false;
  EXPECT_NEAR(light(SplatPicture(cloud, {}, options.picture).render(options.picture, progress)), expected, 0.02)
      << "splats";
}

/// Constant curvature.
class ConstantCurvature final : public CurvatureField {
 public:
  explicit ConstantCurvature(float curvature) : curvature_(curvature) {}
  void evaluate(std::span<const Vec3>, std::span<const Vec3f>,
                std::span<PrincipalCurvatures> curvatures) const override {
    std::fill(curvatures.begin(), curvatures.end(),
              PrincipalCurvatures{curvature_, curvature_, {1, 0, 0}, {0, 1, 0}, true});
  }

 private:
  float curvature_;
};

TEST(Accessibility, BendsGiveAndTakeLight) {
  const TriangleMesh ball = test::octasphere(4);
  const double diagonal = std::sqrt(12.0);
  Progress progress;
  for (const float curvature : {-3.0f, -0.5f, 0.0f, 0.5f}) {
    RenderOptions options = open_light(0.2, 0.4);
    options.look.curvature = std::make_shared<ConstantCurvature>(curvature);
    options.look.surface_color = {0.5f, 0.5f, 0.5f};  // below the compression of highlights
    const Image image = render_mesh(ball, options, progress);
    const double expected = 1 + 0.4 * 2 / std::numbers::pi * std::atan(static_cast<double>(curvature) * 0.2 * diagonal);
    EXPECT_NEAR(light_at(image, options, kWidth / 2, kWidth / 2), expected, 5e-3) << curvature;
  }
}

TEST(Accessibility, WhatIsBentInAsFarAsCanBeIsDarkNotLit) {
  const TriangleMesh ball = test::octasphere(3);
  Progress progress;
  for (const float curvature : {-1e30f, -std::numeric_limits<float>::infinity()}) {
    RenderOptions options = open_light(0.2, 1);
    options.look.curvature = std::make_shared<ConstantCurvature>(curvature);
    const Image image = render_mesh(ball, options, progress);
    EXPECT_LT(light_at(image, options, kWidth / 2, kWidth / 2), 1e-3) << curvature;
  }
}

TEST(Accessibility, DoesNotDependOnThreads) {
  const TriangleMesh half = bowl(std::numbers::pi / 2);
  const test::Spheres sphere({1});
  RenderOptions options = open_light(0.3, 0.5);
  options.view.direction = {20, 40};
  options.look.curvature = std::make_shared<LevelSetCurvature>(sphere, 0.01);
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    return render_mesh(half, options, progress).pixels;
  });
}

TEST(Accessibility, WrongOptionsAreNamed) {
  EXPECT_THROW(open_light(0).validate(), ArgumentError);
  EXPECT_THROW(open_light(0.1, 2).validate(), ArgumentError);
  EXPECT_THROW(open_light(0.1, -0.5).validate(), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
