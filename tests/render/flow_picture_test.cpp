// Streaks along flows, splats and translucent sheets.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/render/scene/flow_texture.h"
#include "sansmesh/render/splat/splat_scene.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kSize = 160;

/// A square of n × n vertices and width 2 around the origin in the plane of two unit vectors.
FlowSubject square(int n, const Vec3f& u, const Vec3f& v, const Vec3f& vector) {
  FlowSubject subject;
  TriangleMesh& mesh = subject.mesh;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto at = [&](int k) { return 2 * static_cast<float>(k) / static_cast<float>(n - 1) - 1; };
      mesh.vertices.push_back(at(i) * u + at(j) * v);
      subject.vectors.push_back(vector);
      subject.fronts.push_back(j);
    }
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * n + i); };
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  return subject;
}

/// Looks down the z axis at width 2 around the origin.
Camera from_above(float distance = 4) {
  Camera camera;
  camera.position = {0, 0, distance};
  camera.right = {1, 0, 0}, camera.up = {0, 1, 0}, camera.backward = {0, 0, 1};
  camera.half_width = camera.half_height = 1 / distance;
  return camera;
}

RenderOptions plain(int size = kSize) {
  RenderOptions options;
  options.view.width = options.view.height = size;
  options.quality.samples = 1;
  options.quality.occlusion_rays = 0;
  options.look.shadows = options.look.ground = false;
  return options;
}

/// Factors of all pixels of a surface that fills the picture; 0 outside.
std::vector<double> factors(const PictureScene& scene, const Camera& camera, const FlowTextureOptions& options) {
  FlowTexture texture(scene, camera, kSize, kSize);
  texture.convolve(options);
  std::vector<double> found;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const Vec3f d = camera.direction((2.0f * static_cast<float>(x) + 1) / kSize - 1,
                                       1 - (2.0f * static_cast<float>(y) + 1) / kSize);
      std::optional<SurfacePoint> point;
      scene.closest({{&camera.position, 1}, {&d, 1}}, {&point, 1});
      found.push_back(point ? static_cast<double>(texture.factor(camera.position, d, *point)) : 0);
    }
  return found;
}

/// Angle of the streaks against the right, in degrees −90..90: the direction in which pixels 5 to 13 apart are most
/// similar. (A single distance would favour directions towards pixel centres.)
double streak_angle(const std::vector<double>& f) {
  constexpr int kRim = 15;
  double best = -1, angle = 0;
  for (int degrees = -90; degrees < 90; ++degrees) {
    const double a = degrees * std::numbers::pi / 180;
    double alike = 0;
    for (int y = kRim; y + kRim < kSize; y += 3)
      for (int x = kRim; x + kRim < kSize; x += 3)
        for (double r = 5; r < 13; r += 0.7) {
          const double p = x + r * std::cos(a), q = y - r * std::sin(a), u = std::floor(p), v = std::floor(q);
          const double s = p - u, t = q - v;
          const auto at = [&](int i, int j) {
            return f[static_cast<std::size_t>((static_cast<int>(v) + j) * kSize + static_cast<int>(u) + i)] - 1;
          };
          alike += (f[static_cast<std::size_t>(y * kSize + x)] - 1) *
                   ((1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1)));
        }
    if (alike > best) best = alike, angle = degrees;
  }
  return angle;
}

std::unique_ptr<PictureScene> scene_of(const FlowSubject& subject, const FlowLook& look = {std::nullopt, 1, false}) {
  return DrawnFlow(subject, plain()).surface(look)({}, from_above());
}

TEST(FlowTexture, StreaksFollowTheFlow) {
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, -60.0}) {
    const double a = degrees * std::numbers::pi / 180;
    const Vec3f along(Vec3{std::cos(a), std::sin(a), 0});
    const auto scene = scene_of(square(2, {1, 0, 0}, {0, 1, 0}, along));
    const std::vector<double> f = factors(*scene, from_above(), {});
    EXPECT_NEAR(streak_angle(f), degrees, 1) << degrees;
    double sum = 0, squares = 0;
    for (const double v : f) sum += v, squares += v * v;
    const double n = static_cast<double>(f.size()), mean = sum / n;
    EXPECT_NEAR(mean, 1, 0.03);
    const double spread = std::sqrt(squares / n - mean * mean);
    EXPECT_GT(spread, 0.25);
    EXPECT_LT(spread, 0.55);
  }
}

TEST(FlowTexture, StreaksFollowTheFlowAsItIsSeenAtAnAngle) {
  // A plane that leans back by 60° with a flow at 45° in it.
  const Vec3f v(Vec3{0, 0.5, -std::sqrt(0.75)});
  const auto scene = scene_of(square(2, {1.5f, 0, 0}, v * 3.0f, Vec3f{1, 0, 0} + v));
  // From afar: parallel lines stay parallel.
  EXPECT_NEAR(streak_angle(factors(*scene, from_above(100), {})), std::atan(0.5) * 180 / std::numbers::pi, 1);
}

TEST(FlowTexture, ContrastIsTheSameHoweverThePlaneLeans) {
  for (const double degrees : {0.0, 60.0, 80.0}) {
    const double a = degrees * std::numbers::pi / 180;
    const Vec3f v(Vec3{0, std::cos(a), -std::sin(a)});
    const auto scene = scene_of(square(2, {1, 0, 0}, v * static_cast<float>(1 / std::cos(a)), v));
    double sum = 0, squares = 0, n = 0;
    for (const double f : factors(*scene, from_above(100), {}))
      if (f > 0) sum += f, squares += f * f, ++n;
    EXPECT_GT(n, 0.9 * kSize * kSize);
    EXPECT_NEAR(std::sqrt(squares / n - sum / n * sum / n), 0.38, 0.06) << degrees;
  }
}

TEST(FlowTexture, WithoutAFlowThereIsNothing) {
  // Into the plane: no tangential component.
  for (const Vec3f vector : {Vec3f{0, 0, 0}, Vec3f{0, 0, 1}})
    for (const double f : factors(*scene_of(square(2, {1, 0, 0}, {0, 1, 0}, vector)), from_above(), {}))
      ASSERT_EQ(f, 1);
}

TEST(FlowTexture, WavesRunWithTheFlow) {
  const auto scene = scene_of(square(2, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}));
  FlowTextureOptions options;
  options.streak_length = 30;
  const auto at = [&](double phase) {
    options.phase = phase;
    return factors(*scene, from_above(), options);
  };
  const std::vector<double> before = at(0.4), after = at(0.5), end = at(1), begin = at(0);
  for (std::size_t i = 0; i < begin.size(); ++i) ASSERT_NEAR(begin[i], end[i], 1e-5);
  // The later picture best matches the earlier one shifted to the right, by a tenth of a wave of 16 steps.
  double best = -1;
  int best_shift = 0;
  for (int shift = -4; shift <= 4; ++shift) {
    double match = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 8; x + 8 < kSize; ++x)
        match += (after[static_cast<std::size_t>(y * kSize + x)] - 1) *
                 (before[static_cast<std::size_t>(y * kSize + x - shift)] - 1);
    if (match > best) best = match, best_shift = shift;
  }
  EXPECT_GE(best_shift, 1);
  EXPECT_LE(best_shift, 3);
}

TEST(FlowTexture, StreaksEndWhereAnotherSheetBegins) {
  // The left half is nearer and flows up, the right half flows to the right: neither affects the other.
  FlowSubject both = square(2, {0.5f, 0, 0}, {0, 1, 0}, {0, 1, 0});
  for (Vec3f& p : both.mesh.vertices) p += Vec3f{-0.5f, 0, 0.5f};
  const FlowSubject right = square(2, {0.5f, 0, 0}, {0, 1, 0}, {1, 0, 0});
  for (std::size_t i = 0; i < 4; ++i) both.mesh.vertices.push_back(right.mesh.vertices[i] + Vec3f{0.5f, 0, 0});
  both.vectors.insert(both.vectors.end(), right.vectors.begin(), right.vectors.end());
  both.fronts.assign(8, 0);
  for (Triangle t : right.mesh.triangles) both.mesh.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  const auto scene = scene_of(both);
  const std::vector<double> f = factors(*scene, from_above(), {});
  // Right of the border the contrast is kept, although streaks are shorter.
  double sum = 0, squares = 0;
  int n = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = kSize / 2 + 1; x < kSize / 2 + 6; ++x, ++n) {
      const double v = f[static_cast<std::size_t>(y * kSize + x)];
      sum += v, squares += v * v;
    }
  EXPECT_GT(std::sqrt(squares / n - sum / n * sum / n), 0.25);
}

TEST(FlowTexture, OptionsAreChecked) {
  const auto scene = scene_of(square(2, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}));
  FlowTexture texture(*scene, from_above(), 8, 8);
  EXPECT_THROW(texture.convolve({0, 1.5, 0.4, {}}), ArgumentError);
  EXPECT_THROW(texture.convolve({40, 0.1, 0.4, {}}), ArgumentError);
  EXPECT_THROW(texture.convolve({40, 1.5, 2, {}}), ArgumentError);
  EXPECT_THROW(texture.convolve({40, 1.5, 0.4, -0.1}), ArgumentError);
  FlowSubject wrong = square(2, {1, 0, 0}, {0, 1, 0}, {1, 0, 0});
  wrong.vectors.pop_back();
  EXPECT_THROW(DrawnFlow(wrong, plain()), ArgumentError);
}

/// The layers along a ray straight down at (x, y).
std::vector<SurfacePoint> layers_at(const PictureScene& scene, float x, float y) {
  const Vec3f eye = from_above().position, d = normalized(Vec3f{x, y, 0} - eye);
  std::vector<std::size_t> first;
  std::vector<SurfacePoint> points;
  scene.layers({{&eye, 1}, {&d, 1}}, first, points);
  EXPECT_EQ(first, (std::vector<std::size_t>{0, points.size()}));
  return points;
}

TEST(TranslucentSheet, AllLayersAreFoundFrontToBack) {
  FlowSubject subject = square(9, {1, 0, 0}, {0, 1, 0}, {1, 0, 0});
  const FlowSubject below = square(9, {1, 0, 0}, {0, 1, 0}, {1, 0, 0});
  const auto n = static_cast<std::uint32_t>(subject.mesh.vertices.size());
  for (const Vec3f& p : below.mesh.vertices) {
    subject.mesh.vertices.push_back(p - Vec3f{0, 0, 0.5f});
    subject.vectors.push_back({0, 1, 0});
    subject.fronts.push_back(1000);
  }
  for (const Triangle& t : below.mesh.triangles) subject.mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  for (const bool splats : {false, true}) {
    const auto scene = scene_of(subject, {std::nullopt, 0.25, splats});
    const auto points = layers_at(*scene, 0.31f, 0.17f);
    ASSERT_EQ(points.size(), 2u) << splats;
    EXPECT_NEAR(points[0].position.z, 0, 0.2);
    EXPECT_NEAR(points[1].position.z, -0.5, 0.2);
    EXPECT_GT(points[0].vector.x, 0.9f);
    EXPECT_GT(points[1].vector.y, 0.9f);
    // Seen at an angle its thickness is 1 / cos times larger.
    const double cosine = dot(Vec3(0, 0, 1), normalized(Vec3{-0.31, -0.17, 4}));
    EXPECT_NEAR(points[0].opacity, 1 - std::pow(0.75, 1 / cosine), 1e-3);
    EXPECT_EQ(layers_at(*scene_of(subject, {std::nullopt, 1, splats}), 0.31f, 0.17f).size(), 1u) << "opaque";
  }
}

TEST(TranslucentSheet, PicturesLetWhatIsBehindThrough) {
  RenderOptions options = plain(48);
  options.look.background = Background::transparent();
  options.view.direction = {0, 0};
  const FlowSubject subject = square(2, {1, 0, 0}, {0, 1, 0}, {1, 0, 0});
  std::vector<Vec3> places;
  for (const Vec3f& p : subject.mesh.vertices) places.emplace_back(p);
  Progress progress;
  const auto picture = [&](int sheets) {
    FlowLook look{std::nullopt, 0.3, false};
    std::vector<SceneFactory> surfaces;
    for (int k = 0; k < sheets; ++k) {
      FlowSubject moved = subject;
      moved.mesh.origin = {0, 0, -0.01 * k};
      surfaces.push_back(DrawnFlow(moved, options).surface(look));
    }
    return render_surfaces(surfaces, places, true, options, progress);
  };
  const auto alpha = [](const Image& image) { return static_cast<double>(image.at(24, 24)[3]); };
  EXPECT_NEAR(alpha(picture(1)), 0.3, 0.003);
  EXPECT_NEAR(alpha(picture(3)), 1 - std::pow(0.7, 3), 0.003);
}

TEST(SplatScene, NeighboursInTimeBlendOthersDoNot) {
  // Two discs at nearly the same position, red and green.
  Splats splats;
  splats.centers = {{0, 0, 0}, {0.2f, 0, -0.02f}};
  splats.normals = {{0, 0, 1}, {0, 0, 1}};
  splats.vectors = {{1, 0, 0}, {0, 1, 0}};
  splats.colors = {{1, 0, 0}, {0, 1, 0}};
  splats.spacings = {1, 1};
  splats.reaches = {1, 1};
  const auto seen = [&](std::int32_t other) {
    splats.fronts = {0, other};
    const SplatScene scene(splats, 1);
    return layers_at(scene, 0.1f, 0).at(0);
  };
  const SurfacePoint blended = seen(1), crisp = seen(2);
  // r² is the same, and s = 0.02 / γ h: exp(−0.0016) for the second.
  const double share = 1 / (1 + std::exp(-std::pow(0.02 / 0.5, 2)));
  EXPECT_NEAR(blended.color.x, share, 2e-3);
  EXPECT_NEAR(blended.color.y, 1 - share, 2e-3);
  EXPECT_NEAR(blended.vector.y, 1 - share, 2e-3);
  EXPECT_EQ(crisp.color, (Vec3f{1, 0, 0}));
  EXPECT_EQ(crisp.vector, (Vec3f{1, 0, 0}));
}

TEST(SplatScene, FrontsThatDiscsCoverAreOneSheet) {
  // Oblique fronts, closer together than the width of discs.
  FlowSubject subject = square(13, {1, 0, 0}, {0, 1, 0}, {1, 0, 0});
  for (std::size_t k = 0; k < subject.fronts.size(); ++k)
    subject.fronts[k] = static_cast<std::int32_t>(7 * (k % 13) + 3 * (k / 13));
  const auto scene = scene_of(subject, {std::nullopt, 0.25, true});
  for (float x = -0.7f; x < 0.7f; x += 0.11f) EXPECT_EQ(layers_at(*scene, x, 0.3f * x).size(), 1u) << x;
}

TEST(SplatScene, WhatStandsBeforeThemIsSeen) {
  RenderOptions options = plain(32);
  options.view.direction = {0, 0};
  FlowSubject sheet = square(4, {1, 0, 0}, {0, 1, 0}, {1, 0, 0});
  sheet.mesh.colors.assign(sheet.mesh.vertices.size(), {255, 0, 0});
  TriangleMesh before = square(2, {0.5f, 0, 0}, {0, 0.5f, 0}, {}).mesh;
  before.origin = {0, 0, 0.02};  // far less than the width of a disc
  before.colors.assign(before.vertices.size(), {0, 255, 0});
  std::vector<Vec3> places;
  for (const Vec3f& p : sheet.mesh.vertices) places.emplace_back(p);
  Progress progress;
  const std::vector<SceneFactory> surfaces = {DrawnFlow(sheet, options).surface({std::nullopt, 1, true}),
                                              scene_factory(before, options)};
  for (const bool translucent : {false, true}) {
    const Image image = render_surfaces(surfaces, places, translucent, options, progress);
    EXPECT_GT(image.at(16, 16)[1], 2 * image.at(16, 16)[0]) << translucent;
    EXPECT_GT(image.at(16, 6)[0], 2 * image.at(16, 6)[1]) << translucent;
  }
}

TEST(SplatScene, NormalsAreThoseOfTheSurface) {
  TriangleMesh sphere = test::octasphere(5);
  const std::vector<std::int32_t> fronts(sphere.vertices.size(), 0);
  const Splats splats = splats_at_vertices(sphere, {}, fronts, {}, {});
  ASSERT_EQ(splats.centers.size(), sphere.vertices.size());
  for (std::size_t i = 0; i < splats.centers.size(); ++i)
    ASSERT_GT(dot(splats.normals[i], splats.centers[i]), 0.999f) << "outwards as the triangles";
  // There is no gap: all rays from the centre meet the sphere.
  const SplatScene scene(splats, 1);
  for (const Vec3f& p : sphere.vertices) {
    const Vec3f d = normalized(p + Vec3f{0.003f, 0.011f, -0.007f});
    std::optional<SurfacePoint> point;
    const Vec3f eye{0, 0, 0};
    scene.closest({{&eye, 1}, {&d, 1}}, {&point, 1});
    ASSERT_TRUE(point);
    EXPECT_NEAR(norm(point->position - point->normal * (0.5f * splats.spacings[0])), 1, 0.02);
  }
}

TEST(FlowPicture, IsTheSameForAnyThreads) {
  const FlowSubject subject = square(20, {1, 0, 0}, {0, 0.6f, 0.8f}, {1, 1, 0});
  std::vector<Vec3> places;
  for (const Vec3f& p : subject.mesh.vertices) places.emplace_back(p);
  for (const bool splats : {false, true})
    for (const double opacity : {0.5, 1.0})
      test::compare_threads(
          [&] {
            Progress progress;
            FlowLook look;
            look.opacity = opacity, look.splats = splats;
            const SceneFactory surface = DrawnFlow(subject, plain(64)).surface(look);
            return render_surfaces({&surface, 1}, places, opacity < 1, plain(64), progress).pixels;
          },
          [](const auto& one, const auto& many) { EXPECT_TRUE(one == many); });
}

}  // namespace
}  // namespace sansmesh::inline v1
