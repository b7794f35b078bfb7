#include "sansmesh/render/annotate/line_drawing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/analytic_surfaces.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/render/scene/mesh_scene.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "sansmesh/render/surface/surface_scene.h"
#include "sansmesh/render_options.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using test::sphere_balls;

constexpr int kDrawingSize = 160;

/// F / ‖∇F‖, an approximate distance near the surface.
class NearDistance : public ScalarField {
 public:
  Box3 bounds() const override { return {{-3, -3, -3}, {3, 3, 3}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec3 g;
      const double f = formula(x[i], g), slope = norm(g);
      values[i] = f / slope;
      if (!gradients.empty()) gradients[i] = g / slope;
    }
  }

 protected:
  virtual double formula(const Vec3& x, Vec3& gradient) const = 0;
};

constexpr double kWave = 6, kHeight = 0.08;
/// z = height · cos(wave · x): its crests are straight.
class Waves final : public NearDistance {
  double formula(const Vec3& x, Vec3& g) const override {
    g = {kHeight * kWave * std::sin(kWave * x.x), 0, 1};
    return x.z - kHeight * std::cos(kWave * x.x);
  }
};

constexpr double kRing = 1, kTubeWide = 0.25, kTubeTall = 0.45;
/// A torus around z with an upright elliptic section: its curvature is largest along the circles at its top and bottom.
class TallRing final : public NearDistance {
  double formula(const Vec3& x, Vec3& g) const override {
    const double ring = std::hypot(x.x, x.y), out = ring - kRing;
    g = {2 * out / (kTubeWide * kTubeWide) * x.x / ring, 2 * out / (kTubeWide * kTubeWide) * x.y / ring,
         2 * x.z / (kTubeTall * kTubeTall)};
    return out * out / (kTubeWide * kTubeWide) + x.z * x.z / (kTubeTall * kTubeTall) - 1;
  }
};

BallUnion balls_at(const std::vector<Vec3>& points, float radius) {
  BallUnion balls;
  for (const Vec3& p : points) balls.centers.push_back(Vec3f(p)), balls.radii.push_back(radius);
  return balls;
}

BallUnion wave_balls() {
  std::vector<Vec3> points;
  for (double x = -1; x <= 1.001; x += 0.05)
    for (double y = -1; y <= 1.001; y += 0.05) points.push_back({x, y, kHeight * std::cos(kWave * x)});
  return balls_at(points, 0.08f);
}

BallUnion ring_balls() {
  std::vector<Vec3> points;
  for (int i = 0; i < 120; ++i)
    for (int j = 0; j < 50; ++j) {
      const double u = 2 * std::numbers::pi * i / 120, v = 2 * std::numbers::pi * j / 50;
      const double r = kRing + kTubeWide * std::cos(v);
      points.push_back({r * std::cos(u), r * std::sin(u), kTubeTall * std::sin(v)});
    }
  return balls_at(points, 0.1f);
}

struct Drawing {
  Camera camera;
  PixelMap<float> ink;
};

/// From above (y is up, z towards the viewer); 1 in the picture's plane is a share of its half.
Drawing draw(const ScalarField& field, const BallUnion& balls, std::shared_ptr<const CurvatureField> curvature,
             SurfaceRenderOptions options = {}) {
  options.picture.view.width = options.picture.view.height = kDrawingSize;
  options.picture.quality.samples = 3;
  options.picture.view.direction = {0, 0};
  options.picture.look.curvature = std::move(curvature);
  const SurfaceCaster caster(field, balls);
  const PictureFrame frame{{}, 2};
  std::vector<Vec3f> points;
  for (const Vec3f& p : balls.centers) points.push_back(frame.to_picture(Vec3(p)));
  Drawing d{picture_camera(points, frame, options.picture), {}};
  options.picture.look.shadows = options.picture.look.ground = false;
  options.picture.quality.occlusion_rays = 0;
  const SurfaceScene scene(caster, frame, d.camera, nullptr, options);
  Progress progress;
  d.ink = line_ink(scene, d.camera, frame, options.picture, progress);
  return d;
}

/// Centre of a pixel in world coordinates, for parallel rays.
Vec3 place_of(const Drawing& d, int x, int y) {
  const double half = 2 * static_cast<double>(d.camera.half_width);  // the frame's unit
  return {((2 * x + 1.0) / kDrawingSize - 1) * half, (1 - (2 * y + 1.0) / kDrawingSize) * half, 0};
}

TEST(LineInk, ASpheresSilhouetteIsWhereItTurnsAway) {
  const test::Spheres sphere({1});
  const BallUnion balls = sphere_balls(3000);
  for (const bool parallel : {true, false}) {
    SurfaceRenderOptions options;
    options.picture.view.orthographic = parallel;
    options.picture.look.line_width = 2;
    const Drawing d = draw(sphere, balls, nullptr, options);
    // n · v = 0 on a circle, whose tangents from the eye make the sphere look larger.
    const double far = 2 * static_cast<double>(norm(d.camera.position)),
                 half = static_cast<double>(d.camera.half_width);
    const double radius = (parallel ? 0.5 / half : std::tan(std::asin(1 / far)) / half) * kDrawingSize / 2;
    double ink = 0, mean = 0;
    for (int y = 0; y < kDrawingSize; ++y)
      for (int x = 0; x < kDrawingSize; ++x) {
        const auto w = static_cast<double>(d.ink.at(x, y));
        if (w == 0) continue;
        const double r = std::hypot(x + 0.5 - kDrawingSize / 2.0, y + 0.5 - kDrawingSize / 2.0);
        EXPECT_LT(std::abs(r - radius), 1 + 1 + 0.71) << x << ", " << y;  // half a line, a pixel and half a diagonal
        ink += w, mean += w * r;
      }
    EXPECT_NEAR(mean / ink, radius, 0.3);
    EXPECT_NEAR(ink, 2 * std::numbers::pi * radius * options.picture.look.line_width, 0.15 * ink);
  }
}

TEST(LineInk, CrestsOfWavesAreWhereTheFormulaHasThem) {
  const Waves waves;
  const auto curvature = std::make_shared<LevelSetCurvature>(waves, 0.01);
  SurfaceRenderOptions options;
  options.picture.view.orthographic = true;
  options.picture.look.line_strength = 2;
  const Drawing d = draw(waves, wave_balls(), curvature, options);
  const double pixel = 4 * static_cast<double>(d.camera.half_width) / kDrawingSize;
  int on = 0;
  std::vector<int> rows(kDrawingSize);
  for (int y = 0; y < kDrawingSize; ++y)
    for (int x = 0; x < kDrawingSize; ++x) {
      const Vec3 at = place_of(d, x, y);
      if (std::max(std::abs(at.x), std::abs(at.y)) > 0.93 || d.ink.at(x, y) < 0.05f) continue;
      // Ridges at integer multiples of 2π/wave, valleys between.
      const double turns = at.x * kWave / std::numbers::pi;
      EXPECT_LT(std::abs(turns - std::round(turns)) * std::numbers::pi / kWave, 2 * pixel) << x << ", " << y;
      ++on, ++rows[static_cast<std::size_t>(y)];
    }
  // About three lines in every row.
  EXPECT_GT(on, 0);
  for (int y = 0; y < kDrawingSize; ++y)
    if (std::abs(place_of(d, kDrawingSize / 2, y).y) < 0.9) EXPECT_GE(rows[static_cast<std::size_t>(y)], 3) << y;
}

TEST(LineInk, ATallRingsRidgeIsTheCircleAtItsTop) {
  const TallRing ring;
  const auto curvature = std::make_shared<LevelSetCurvature>(ring, 0.01);
  SurfaceRenderOptions options;
  options.picture.view.orthographic = true;
  options.picture.look.line_strength = 5;  // the value is 14.4 there
  const Drawing d = draw(ring, ring_balls(), curvature, options);
  const double pixel = 4 * static_cast<double>(d.camera.half_width) / kDrawingSize;
  double ink = 0, mean = 0;
  for (int y = 0; y < kDrawingSize; ++y)
    for (int x = 0; x < kDrawingSize; ++x) {
      const double r = norm(place_of(d, x, y)), w = static_cast<double>(d.ink.at(x, y));
      if (std::abs(r - kRing) > 0.7 * kTubeWide || w == 0) continue;
      EXPECT_LT(std::abs(r - kRing), 2 * pixel) << x << ", " << y;
      ink += w, mean += w * r;
    }
  EXPECT_NEAR(mean / ink, kRing, 0.3 * pixel);
  EXPECT_NEAR(ink * pixel, 2 * std::numbers::pi * kRing * options.picture.look.line_width, 0.35 * ink * pixel);
}

TEST(LineInk, WhatIsEvenlyBentHasNoCrests) {
  const test::Spheres sphere({1});
  const auto of_sphere = std::make_shared<LevelSetCurvature>(sphere, 0.02);
  const test::Torus torus;
  const auto of_torus = std::make_shared<LevelSetCurvature>(torus, 0.02);
  SurfaceRenderOptions options;
  options.picture.view.orthographic = true;
  options.picture.look.line_strength = 0.5;
  const Drawing round = draw(sphere, sphere_balls(3000), of_sphere, options);
  const Drawing ring = draw(torus, test::torus_balls(6000, 3), of_torus, options);
  for (int y = 0; y < kDrawingSize; ++y)
    for (int x = 0; x < kDrawingSize; ++x) {
      if (norm(place_of(round, x, y)) < 0.9) EXPECT_EQ(round.ink.at(x, y), 0) << x << ", " << y;
      if (std::abs(norm(place_of(ring, x, y)) - 1) < 0.25) EXPECT_EQ(ring.ink.at(x, y), 0) << x << ", " << y;
    }
}

TEST(LineInk, DoesNotDependOnThreads) {
  const Waves waves;
  const auto curvature = std::make_shared<LevelSetCurvature>(waves, 0.01);
  const BallUnion balls = wave_balls();
  test::expect_equal_for_any_threads([&] { return draw(waves, balls, curvature).ink.pixels; });
}

TriangleMesh cube_mesh() {
  TriangleMesh cube;
  for (int k = 0; k < 8; ++k)
    cube.vertices.push_back({k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f});
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return cube;
}

TEST(RenderLines, ACubesEdgesAreDrawnOnWhite) {
  const TriangleMesh cube = cube_mesh();
  RenderOptions options;
  options.view.width = options.view.height = kDrawingSize;
  options.view.direction = {30, 25};
  options.look.lines = PictureLook::Lines::only;
  Progress progress;
  const Image lines = render_mesh(cube, options, progress);
  const Subject subject = make_subject(cube, options);
  const Camera camera = picture_camera(subject.mesh.vertices, subject.frame, options);
  const auto pixel_of = [&](const Vec3& x) {
    const ProjectedPoint p = camera.project(subject.frame.to_picture(x));
    return Vec3{(static_cast<double>(p.x) + 1) * kDrawingSize / 2, (1 - static_cast<double>(p.y)) * kDrawingSize / 2,
                0};
  };
  const auto darkness = [&](const Vec3& at) {
    float least = 1;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u)
        least = std::min(least, lines.at(static_cast<int>(at.x) + u, static_cast<int>(at.y) + v)[1]);
    return 1 - least;
  };
  // The middles of the three edges at the nearest corner; faces and surroundings are white.
  EXPECT_GT(darkness(pixel_of({1, 0, 1})), 0.5f);
  EXPECT_GT(darkness(pixel_of({0, 1, 1})), 0.5f);
  EXPECT_GT(darkness(pixel_of({1, 1, 0})), 0.5f);
  EXPECT_EQ(darkness(pixel_of({0, 0, 1})), 0);
  EXPECT_EQ(darkness(pixel_of({0, 1, 0})), 0);
  EXPECT_EQ(darkness({3, 3, 0}), 0);
  // Over the lit surface, pixels without lines are unchanged.
  options.look.lines = PictureLook::Lines::none;
  const Image lit = render_mesh(cube, options, progress);
  options.look.lines = PictureLook::Lines::over;
  const Image over = render_mesh(cube, options, progress);
  for (std::size_t i = 0; i < lit.pixels.size(); ++i)
    if (lines.pixels[i][1] == 1) EXPECT_EQ(over.pixels[i], lit.pixels[i]);
  EXPECT_NE(over.pixels, lit.pixels);
}

TEST(DrawInk, CoversWhatIsThere) {
  Image image(3, 1, {1, 1, 1, 1});
  image.at(2, 0) = {0, 0, 0, 0};
  PixelMap<float> ink(3, 1, 0.25f);
  ink.at(0, 0) = 0;
  draw_ink(image, ink, {0, 0.5f, 1});
  EXPECT_EQ(image.at(0, 0), (Rgba{1, 1, 1, 1}));
  EXPECT_EQ(image.at(1, 0), (Rgba{0.75f, 0.875f, 1, 1}));
  EXPECT_EQ(image.at(2, 0), (Rgba{0, 0.5f, 1, 0.25f}));
}

}  // namespace
}  // namespace sansmesh::inline v1
