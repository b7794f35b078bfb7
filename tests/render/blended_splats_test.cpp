#include "sansmesh/render/splat/blended_splats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/render/splat/splat_footprint.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kWide = 120, kHigh = 90;

Camera tilted_camera(bool parallel) {
  const std::vector<Vec3f> points{{-0.4f, -0.3f, -0.2f}, {0.5f, 0.2f, 0.3f}};
  return frame_camera(points, {30, 25}, UpAxis::y, 40, static_cast<double>(kWide) / kHigh, 0.1, 0, parallel);
}

/// Projection of a point in pixels.
Vec3 pixel_of(const Camera& camera, const Vec3f& x) {
  const ProjectedPoint place = camera.project(x);
  return {(1 + static_cast<double>(place.x)) * 0.5 * kWide, (1 - static_cast<double>(place.y)) * 0.5 * kHigh, 0};
}

/// Points of a plane through 0, a jittered hexagonal lattice of this spacing, extending `half` to each side.
PointSet plane_cloud(const Vec3f& normal, float spacing, float half) {
  PointSet cloud;
  Vec3f t, b;
  tangent_frame(normal, t, b);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> jitter(-0.2f * spacing, 0.2f * spacing);
  const float row = spacing * std::sqrt(0.75f);
  const int rows = static_cast<int>(half / row), columns = static_cast<int>(half / spacing);
  for (int j = -rows; j <= rows; ++j)
    for (int i = -columns; i <= columns; ++i) {
      const float x = (static_cast<float>(i) + (j % 2 == 0 ? 0.0f : 0.5f)) * spacing + jitter(random);
      const float y = static_cast<float>(j) * row + jitter(random);
      cloud.positions.push_back(x * t + y * b);
      cloud.normals.push_back(normal);
    }
  return cloud;
}

PointSet sphere_points(int count) {
  PointSet cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
    cloud.positions.push_back(Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z}));
    cloud.normals.push_back(cloud.positions.back());
  }
  return cloud;
}

float cover_of(std::span<const SplatLayer> layers) {
  float sum = 0;
  for (const SplatLayer& layer : layers) sum += layer.share;
  return sum;
}

TEST(SplatFootprint, IsTheGaussianOfTheMapsDerivative) {
  const Vec3f center{0.1f, 0.05f, -0.1f}, a{0.05f, 0.02f, -0.01f}, b{0.01f, -0.02f, 0.015f};
  for (const bool parallel : {false, true}) {
    const Camera camera = tilted_camera(parallel);
    constexpr float kFilter = 0.6f;
    const auto f = splat_footprint(camera, kWide, kHigh, center, a, b, kFilter);
    ASSERT_TRUE(f);
    const Vec3 middle = pixel_of(camera, center);
    EXPECT_NEAR(f->x, middle.x, 1e-3);
    EXPECT_NEAR(f->y, middle.y, 1e-3);
    constexpr float kStep = 0.05f;
    const Vec3 u = (pixel_of(camera, center + kStep * a) - pixel_of(camera, center - kStep * a)) / (2.0 * kStep);
    const Vec3 v = (pixel_of(camera, center + kStep * b) - pixel_of(camera, center - kStep * b)) / (2.0 * kStep);
    const double xx = u.x * u.x + v.x * v.x + kFilter * kFilter, yy = u.y * u.y + v.y * v.y + kFilter * kFilter,
                 xy = u.x * u.y + v.x * v.y, det = xx * yy - xy * xy, area = std::abs(u.x * v.y - u.y * v.x);
    EXPECT_NEAR(f->xx, yy / det, 2e-3 * yy / det);
    EXPECT_NEAR(f->xy, -xy / det, 2e-3 * yy / det);
    EXPECT_NEAR(f->yy, xx / det, 2e-3 * xx / det);
    EXPECT_NEAR(f->peak, area / std::sqrt(det), 2e-3);
    // The filter moves weight, but preserves its sum.
    double sum = 0;
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x) {
        const float dx = static_cast<float>(x) + 0.5f - f->x, dy = static_cast<float>(y) + 0.5f - f->y;
        sum += static_cast<double>(f->peak * std::exp(-0.5f * f->square(dx, dy)));
      }
    EXPECT_NEAR(sum, 2 * std::numbers::pi * area, 3e-3 * sum);
  }
}

TEST(SplatFootprint, HasTheSplatsOwnCoordinatesWhereTheMapIsAffine) {
  const Camera camera = tilted_camera(true);
  const Vec3f center{0.1f, 0.05f, -0.1f}, a{0.05f, 0.02f, -0.01f}, b{0.01f, -0.02f, 0.015f};
  const auto f = splat_footprint(camera, kWide, kHigh, center, a, b, 0);
  ASSERT_TRUE(f);
  for (const float u : {-2.0f, -0.5f, 1.0f})
    for (const float v : {-1.0f, 0.0f, 2.0f}) {
      const Vec3 at = pixel_of(camera, center + u * a + v * b);
      EXPECT_NEAR(f->square(static_cast<float>(at.x) - f->x, static_cast<float>(at.y) - f->y), u * u + v * v, 2e-3f);
    }
}

TEST(SplatFootprint, IsNothingBehindTheCamera) {
  const Camera camera = tilted_camera(false);
  const Vec3f behind = camera.position + 0.5f * camera.backward;
  EXPECT_FALSE(splat_footprint(camera, kWide, kHigh, behind, {0.1f, 0, 0}, {0, 0.1f, 0}, 0.5f));
  EXPECT_FALSE(splat_footprint(camera, kWide, kHigh, camera.position, {0.1f, 0, 0}, {0, 0.1f, 0}, 0.5f));
}

TEST(SplatLayers, APlaneHasItsNormalAndNoHolesAtAnyZoom) {
  const Vec3f normal = normalized(Vec3f{0.4f, 0.3f, 1});
  const PointSet cloud = plane_cloud(normal, 0.02f, 0.5f);
  const EllipticSplats splats = splats_at_points(cloud, {}, {}, {});
  std::vector<std::vector<SplatStretch>> looks(2);
  looks[1].assign(cloud.size(), {{1, 0.2f, 0}, 1.5f});
  for (const auto& stretches : looks)
    for (const bool parallel : {false, true})
      for (const double factor : {0.2, 1.0, 7.0, -7.0, 60.0, 400.0}) {  // negative: seen from behind
        SCOPED_TRACE(testing::Message() << factor << (parallel ? " parallel" : " perspective"));
        const bool behind = factor < 0;
        const EllipticSplats own = splats_at_points(cloud, stretches, {}, {});
        Camera camera =
            frame_camera(cloud.positions, {behind ? 200.0 : 10.0, 15}, UpAxis::y, 30, 4.0 / 3, 0.1, 0, parallel);
        zoom(camera, std::abs(factor));
        const SplatLayers layers(own, camera, {.width = kWide, .height = kHigh});
        int inside = 0;
        for (int y = 0; y < kHigh; ++y)
          for (int x = 0; x < kWide; ++x) {
            const float u = (2 * static_cast<float>(x) + 1) / kWide - 1,
                        v = 1 - (2 * static_cast<float>(y) + 1) / kHigh;
            const Vec3f origin = camera.origin(u, v), direction = camera.direction(u, v);
            const float t = -dot(origin, normal) / dot(direction, normal);
            const Vec3f at = origin + t * direction;
            // Away from the border by the width of a pixel and a splat.
            const float margin = 0.06f + 3 * 2 * camera.half_height * camera.shrink(norm(at - camera.position)) / kHigh;
            Vec3f tangent, other;
            tangent_frame(normal, tangent, other);
            if (std::max(std::abs(dot(at, tangent)), std::abs(dot(at, other))) > 0.5f - margin) continue;
            ++inside;
            const auto found = layers.at(x, y);
            ASSERT_EQ(found.size(), 1U) << x << ", " << y;
            EXPECT_EQ(found[0].share, 1) << x << ", " << y;
            EXPECT_LT(norm(found[0].normal - (behind ? -normal : normal)), 1e-6f);
            EXPECT_NEAR(found[0].distance, t, 2e-5f * t);
          }
        EXPECT_GT(inside, 20);
      }
}

TEST(SplatLayers, ASphereCoversItsDiscAndHasItsNormals) {
  const EllipticSplats splats = splats_at_points(sphere_points(8000), {}, {}, {});
  const Camera camera = frame_camera(splats.centers, {0, 0}, UpAxis::y, 30, 1, 0.1, 0, true);
  constexpr int kSize = 200;
  const SplatLayers layers(splats, camera, {.width = kSize, .height = kSize});
  const double pixel = 2.0 * static_cast<double>(camera.half_height) / kSize;
  double area = 0, worst = 1;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const auto found = layers.at(x, y);
      area += static_cast<double>(cover_of(found)) * pixel * pixel;
      const double px = (x + 0.5 - 0.5 * kSize) * pixel, py = (0.5 * kSize - y - 0.5) * pixel, r2 = px * px + py * py;
      if (r2 > 1.1) EXPECT_TRUE(found.empty());
      if (r2 > 0.97) continue;
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].share, 1);
      const Vec3f sphere = static_cast<float>(px) * camera.right + static_cast<float>(py) * camera.up +
                           static_cast<float>(std::sqrt(1 - r2)) * camera.backward;
      worst = std::min(worst, static_cast<double>(dot(sphere, found[0].normal)));
    }
  // Discs extend beyond the silhouette by less than a pixel.
  EXPECT_NEAR(std::sqrt(area / std::numbers::pi), 1, pixel);
  EXPECT_GT(worst, 0.999);
}

TEST(SplatLayers, BordersBeforeAnotherSheetLeaveNoGap) {
  PointSet cloud = plane_cloud({0, 0, 1}, 0.02f, 0.5f);
  PointSet front = plane_cloud({0, 0, 1}, 0.01f, 0.2f);
  const std::size_t back = cloud.size();
  for (const Vec3f& p : front.positions)
    cloud.positions.push_back(p + Vec3f{0, 0, 0.4f}), cloud.normals.push_back({0, 0, 1});
  EllipticSplats splats = splats_at_points(cloud, {}, {}, {});
  for (std::size_t i = 0; i < splats.colors.size(); ++i) splats.colors[i] = i < back ? Vec3f{0, 0, 1} : Vec3f{1, 0, 0};
  const Camera camera = frame_camera(cloud.positions, {0, 0}, UpAxis::y, 30, 1, 0, 0, true);
  constexpr int kSize = 151;
  const SplatLayers layers(splats, camera, {.width = kSize, .height = kSize});
  double red = 0;
  int mixed = 0;
  for (int y = 12; y < kSize - 12; ++y)
    for (int x = 12; x < kSize - 12; ++x) {
      const auto found = layers.at(x, y);
      EXPECT_NEAR(cover_of(found), 1, 1e-5f) << x << ", " << y;
      mixed += found.size() == 2;
      for (const SplatLayer& layer : found) red += static_cast<double>(layer.share * layer.color.x);
    }
  EXPECT_GT(mixed, 50);
  const double pixel = 2.0 * static_cast<double>(camera.half_height) / kSize;
  EXPECT_NEAR(std::sqrt(red) * pixel, 0.41, 0.02);
}

TEST(SplatLayers, WhatIsClippedIsNotThere) {
  const EllipticSplats splats = splats_at_points(sphere_points(4000), {}, {}, {});
  const Camera camera = frame_camera(splats.centers, {0, 0}, UpAxis::y, 30, 1, 0.1, 0, true);
  constexpr int kSize = 60;
  const SplatLayers layers(splats, camera,
                           {.width = kSize, .height = kSize, .clip = Box3f{{-2, -2, -2}, {2, 2, 0.5f}}});
  // The cap is removed: the inside of the back is visible, facing the viewer.
  const auto middle = layers.at(kSize / 2, kSize / 2);
  ASSERT_EQ(middle.size(), 1U);
  EXPECT_GT(dot(middle[0].normal, camera.backward), 0.99f);
  EXPECT_NEAR(middle[0].distance, dot(camera.position, camera.backward) + 1, 0.01f);
}

RenderOptions cut_out_options() {
  RenderOptions o;
  o.view.width = o.view.height = 80;
  o.quality.samples = 2;
  o.look.background = Background::transparent();
  o.look.ground = false;
  return o;
}

TEST(SplatPicture, DoesNotDependOnThreads) {
  const PointSet cloud = sphere_points(3000);
  RenderOptions options = cut_out_options();
  options.look.ground = true;
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    return SplatPicture(cloud, {}, options).render(options, progress).pixels;
  });
}

TEST(SplatPicture, AlphaIsTheCoverAndItsBorderIsSmooth) {
  const RenderOptions options = cut_out_options();
  Progress progress;
  const Image image = SplatPicture(sphere_points(3000), {}, options).render(options, progress);
  EXPECT_EQ(image.at(40, 40)[3], 1);
  EXPECT_EQ(image.at(1, 1)[3], 0);
  // Finer than four rays per pixel can resolve.
  int between = 0;
  for (const Rgba& p : image.pixels) {
    const float quarters = 4 * p[3];
    between += std::abs(quarters - std::round(quarters)) > 0.05f;
  }
  EXPECT_GT(between, 50);
}

/// Dark pixels in a picture of a bright surface.
int dark_pixels(const Image& image) {
  return static_cast<int>(std::count_if(image.pixels.begin(), image.pixels.end(),
                                        [](const Rgba& p) { return p[3] > 0.3f && p[1] < 0.25f; }));
}

TEST(SplatPicture, FacesAtTheBackOfABodyDoNotStandOutAroundItsEdges) {
  // A thin box: its back is just behind its front, and discs of both extend beyond the edges.
  PointSet box;
  constexpr int kSide = 30;
  for (const Vec3f& n :
       {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}}) {
    const Vec3f a{n.y, n.z, n.x}, b{n.z, n.x, n.y};
    for (int j = 0; j <= kSide; ++j)
      for (int i = 0; i <= kSide; ++i) {
        const float u = 2.0f * static_cast<float>(i) / kSide - 1, v = 2.0f * static_cast<float>(j) / kSide - 1;
        const Vec3f p = n + u * a + v * b;
        box.positions.push_back({p.x, p.y, 0.5f * p.z});
        box.normals.push_back(n);
      }
  }
  RenderOptions options = cut_out_options();
  options.view.direction = {-20, 30};
  options.look.shadows = false;
  options.quality.occlusion_rays = 0;
  Progress progress;
  EXPECT_EQ(dark_pixels(SplatPicture(box, {}, options).render(options, progress)), 0);
  // Without a face it is not a body, and the inside of the others is visible.
  std::vector<std::uint8_t> gone(box.size());
  for (std::size_t i = 0; i < gone.size(); ++i) gone[i] = box.normals[i].z > 0;
  remove_samples(box, gone);
  options.view.direction = {0, 0};
  EXPECT_EQ(SplatPicture(box, {}, options).render(options, progress).at(40, 40)[3], 1);
}

TEST(SplatPicture, WrongInputIsNamed) {
  PointSet cloud = sphere_points(100);
  const std::vector<SplatStretch> few(3);
  EXPECT_THROW(SplatPicture(cloud, few, {}), ArgumentError);
  cloud.normals.clear();
  EXPECT_THROW(SplatPicture(cloud, {}, {}), DataError);
  cloud = sphere_points(100);
  std::fill(cloud.normals.begin(), cloud.normals.end(), Vec3f{});
  EXPECT_THROW(SplatPicture(cloud, {}, {}), DataError);
  EXPECT_THROW(SplatPicture(PointSet{}, {}, {}), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
