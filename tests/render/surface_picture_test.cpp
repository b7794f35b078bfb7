#include "sansmesh/render/surface/surface_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "analytic_surfaces.h"
#include "render/picture_levels.h"
#include "sansmesh/error.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

using test::brightness;

SurfaceRenderOptions small_surface_picture() {
  SurfaceRenderOptions options;
  options.picture.view.width = 96;
  options.picture.view.height = 72;
  options.picture.quality.samples = 2;
  options.picture.view.direction = {0, 0};
  options.picture.look.ground = false;
  return options;
}

SurfaceRenderOptions clear_picture() {
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.look.shadows = false;
  options.picture.quality.occlusion_rays = 0;
  options.transmission = 1;
  return options;
}

Image render(const SurfaceCaster& caster, const SurfaceRenderOptions& options, const ColorField* colors = nullptr) {
  Progress progress;
  return render_surface(caster, caster.balls().centers, colors, options, progress);
}

int covered(const Image& image) {
  return static_cast<int>(
      std::count_if(image.pixels.begin(), image.pixels.end(), [](const auto& p) { return p[3] > 0.5f; }));
}

/// Distances to the surface along the rays of a camera; infinite where there is none.
DepthMap surface_depth(const SurfaceCaster& caster, const Camera& camera, int width, int height) {
  std::vector<CastRay> rays;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float u = (2 * static_cast<float>(x) + 1) / static_cast<float>(width) - 1;
      const float v = 1 - (2 * static_cast<float>(y) + 1) / static_cast<float>(height);
      rays.push_back({camera.origin(u, v), camera.direction(u, v)});
    }
  std::vector<CastHit> hits(rays.size());
  caster.cast(rays, hits);
  DepthMap map(width, height, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].hit) map.pixels[i] = hits[i].distance;
  return map;
}

TEST(SurfaceDepth, IsThatOfASphere) {
  const test::Spheres sphere({1});
  const BallUnion balls = test::sphere_balls(8000);
  const SurfaceCaster caster(sphere, balls);
  const Camera camera = frame_camera(balls.centers, {30, 20}, UpAxis::y, 30, 1.5, 0.1);
  const DepthMap map = surface_depth(caster, camera, 90, 60);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 90; ++x) {
      const Vec3f d = camera.direction((2 * x + 1) / 90.0f - 1, 1 - (2 * y + 1) / 60.0f);
      const test::SphereCrossings exact({camera.position, d}, 1);
      if (std::abs(exact.closest - 1) < 1e-3) continue;
      if (exact.near < 0)
        EXPECT_TRUE(std::isinf(map.at(x, y)));
      else
        EXPECT_NEAR(map.at(x, y), exact.near, 2e-4);
    }
}

TEST(SurfaceDepth, AgreesWithThePolygonisedSurface) {
  const test::Torus torus;
  BlockTree blocks({-1.6, -1.6, -1.6}, 3.2);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Vec3 center = blocks.block_center(i);
    double value = 0;
    torus.evaluate(std::span(&center, 1), std::span(&value, 1));
    if (blocks.is_leaf(i) && blocks[i].level < 6 && std::abs(value) < blocks.block_edge(i)) blocks.subdivide(i);
  }
  Progress progress;
  const TriangleMesh mesh = polygonize(torus, std::move(blocks), {}, {}, progress);
  const RayScene triangles = RayScene::triangles(mesh.vertices, mesh.triangles);
  const BallUnion balls = test::torus_balls(30000);
  const SurfaceCaster caster(torus, balls);
  const int n = 160;
  for (const ViewDirection view : {ViewDirection{20, 40}, {0, 5}, {70, 85}}) {
    const Camera camera = frame_camera(balls.centers, view, UpAxis::z, 30, 1, 0.1);
    const DepthMap map = surface_depth(caster, camera, n, n);
    int both = 0, one = 0, far = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const Vec3f d = camera.direction((2 * x + 1.0f) / n - 1, 1 - (2 * y + 1.0f) / n);
        const auto hit = triangles.closest(camera.position, d);
        const bool seen = std::isfinite(map.at(x, y));
        both += hit && seen;
        one += hit.has_value() != seen;
        if (!hit || !seen) continue;
        // Triangles deviate by a share of e²/8 over the radius of curvature, more along slanting rays.
        const float slant = std::abs(dot(hit->normal, d));
        far += std::abs(hit->distance - map.at(x, y)) > 1.5e-3f / slant;
      }
    EXPECT_GT(both, n * n / 20);
    EXPECT_LT(one, 0.01 * both) << "silhouettes";
    EXPECT_LT(far, 0.005 * both) << "depth, but for other sheets next to silhouettes";
  }
}

TEST(SurfacePicture, DoesNotDependOnThreads) {
  const test::Torus torus;
  const BallUnion balls = test::torus_balls(10000);
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.look.ground = true;
  options.picture.view.up = UpAxis::z;
  options.picture.view.direction = {30, 35};
  options.reflection = 0.4;
  options.transmission = 0.3;
  test::expect_equal_for_any_threads([&] { return render(SurfaceCaster(torus, balls), options).pixels; });
}

TEST(SurfacePicture, GlassThatDoesNotRefractIsNotSeen) {
  const test::Spheres sphere({1});
  const SurfaceCaster caster(sphere, test::sphere_balls(8000));
  SurfaceRenderOptions options = clear_picture();
  options.refraction_index = 1;
  options.picture.look.background = Background::solid({0.9f, 0.5f, 0.25f});
  const Image image = render(caster, options);
  for (const auto& p : image.pixels)
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(p[k], image.pixels[0][k], 1 / 255.0);
  // Also the wide gradient: neighbours along the rim of the sphere differ no more than elsewhere.
  options.picture.look.background = Background{};
  const Image wide = render(caster, options);
  for (int y = 1; y < wide.height; ++y)
    for (int x = 1; x < wide.width; ++x) {
      ASSERT_NEAR(wide.at(x, y)[1], wide.at(x - 1, y)[1], 5 / 255.0) << x << " " << y;
      ASSERT_NEAR(wide.at(x, y)[1], wide.at(x, y - 1)[1], 5 / 255.0) << x << " " << y;
    }
}

TEST(SurfacePicture, GlassSphereTurnsTheWorldAround) {
  const test::Spheres sphere({1});
  const SurfaceCaster caster(sphere, test::sphere_balls(8000));
  SurfaceRenderOptions options = clear_picture();
  options.environment = [](const Vec3f& d) { return d.x > 0 ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1}; };
  const auto red = [](const Image& image, int x) { return image.at(x, 36)[0] > image.at(x, 36)[2] + 0.2f; };
  const auto blue = [](const Image& image, int x) { return image.at(x, 36)[2] > image.at(x, 36)[0] + 0.2f; };
  options.refraction_index = 1;
  const Image straight = render(caster, options);
  EXPECT_TRUE(blue(straight, 38));
  EXPECT_TRUE(red(straight, 58));
  options.refraction_index = 1.5;
  const Image inverted = render(caster, options);
  EXPECT_TRUE(red(inverted, 38));
  EXPECT_TRUE(blue(inverted, 58));
}

TEST(SurfacePicture, MirrorsShowWhatTheyShould) {
  const test::Spheres sphere({1});
  const BallUnion balls = test::sphere_balls(20000);
  const SurfaceCaster caster(sphere, balls);
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.quality.samples = 1;
  options.picture.look.shadows = false;
  options.picture.quality.occlusion_rays = 0;
  options.reflection = 1;
  options.environment = [](const Vec3f& d) { return Vec3f{0.5f, 0.5f, 0.5f} + d * 0.5f; };
  const Image image = render(caster, options);

  Box3f box;
  for (const Vec3f& p : balls.centers) box.extend(p);
  std::vector<Vec3f> placed;
  for (const Vec3f& p : balls.centers) placed.push_back((p - box.center()) / box.diagonal());
  const Camera camera = frame_camera(placed, options.picture.view.direction, options.picture.view.up,
                                     options.picture.view.field_of_view, 96.0 / 72, kPictureMargin);
  const Lighting lighting(camera);
  int checked = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3f d = camera.direction((2 * x + 1) / 96.0f - 1, 1 - (2 * y + 1) / 72.0f);
      const CastRay ray{camera.position, d};
      const test::SphereCrossings exact(ray, 1 / box.diagonal());
      if (exact.near < 0) continue;
      const Vec3f normal = normalized(camera.position + d * static_cast<float>(exact.near));
      if (lighting.shine(normal, d) > 1e-3f || lighting.sheen(normal, d) > 1e-3f) continue;  // highlights are added
      ++checked;
      const Vec3f light = options.environment(d - 2 * dot(d, normal) * normal);
      const auto& p = image.at(x, y);
      const Vec3f seen = linear_color({p[0], p[1], p[2]});
      EXPECT_LT(norm(seen - light), 0.03f) << x << " " << y;
    }
  EXPECT_GT(checked, 500);
}

TEST(SurfacePicture, MirrorsShowOtherParts) {
  // A sphere in a bowl that is open towards the viewer.
  const test::Spheres shell({1, 0.4});
  const BallUnion inner = test::sphere_balls(4000, 0.4), outer = test::sphere_balls(12000, 1);
  BallUnion both = inner;
  for (std::size_t i = 0; i < outer.centers.size(); ++i) {
    if (outer.centers[i].z > 0.2f) continue;
    both.centers.push_back(outer.centers[i]);
    both.radii.push_back(outer.radii[i]);
  }
  const SurfaceCaster alone(shell, inner), in_bowl(shell, both);
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.look.shadows = false;
  options.picture.quality.occlusion_rays = 0;
  options.reflection = 0.5;
  options.environment = [](const Vec3f&) { return Vec3f{}; };
  Progress progress;
  const Image without = render_surface(alone, both.centers, nullptr, options, progress);
  const Image with = render_surface(in_bowl, both.centers, nullptr, options, progress);
  EXPECT_NEAR(brightness(with, 48, 36), brightness(without, 48, 36), 2) << "here it mirrors the viewer";
  for (const int x : {37, 58}) EXPECT_GT(brightness(with, x, 36), brightness(without, x, 36) + 50);
}

class LeftAndRight : public ColorField {
 public:
  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override {
    for (std::size_t i = 0; i < x.size(); ++i) colors[i] = x[i].x < 0 ? Vec3f{0.9f, 0.1f, 0.1f} : Vec3f{0.1f, 0.1f, 5};
  }
};

TEST(SurfacePicture, ShowsColors) {
  const test::Spheres sphere({1});
  const SurfaceCaster caster(sphere, test::sphere_balls(4000));
  const LeftAndRight colors;
  SurfaceRenderOptions options = small_surface_picture();
  Image image = render(caster, options, &colors);
  EXPECT_GT(image.at(38, 36)[0], 2 * image.at(38, 36)[2]);
  EXPECT_GT(image.at(58, 36)[2], 2 * image.at(58, 36)[0]);
  options.picture.look.use_colors = false;
  options.picture.look.surface_color = {0.1f, 0.8f, 0.1f};
  image = render(caster, options, &colors);
  EXPECT_GT(image.at(38, 36)[1], 2 * image.at(38, 36)[0]);
}

TEST(SurfacePicture, OpenSurfacesAreLitFromBehindToo) {
  const test::Spheres sphere({1});
  BallUnion balls, all = test::sphere_balls(8000);
  for (std::size_t i = 0; i < all.centers.size(); ++i) {
    if (all.centers[i].z > -0.3f) continue;
    balls.centers.push_back(all.centers[i]);
    balls.radii.push_back(all.radii[i]);
  }
  const SurfaceCaster caster(sphere, balls);
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.look.background = Background::transparent();
  const Image image = render(caster, options);
  EXPECT_GT(covered(image), 1000);
  EXPECT_GT(brightness(image, 48, 36), 250);
}

TEST(SurfacePicture, ShadowsOfDiscsAreLikeThoseOfTheSurface) {
  const test::Torus torus;
  const SurfaceCaster caster(torus, test::torus_balls(20000));
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.view.up = UpAxis::z;
  options.picture.view.direction = {20, 25};
  options.picture.look.ground = true;
  const Image quick = render(caster, options);
  options.exact_shadows = true;
  const Image exact = render(caster, options);
  options.picture.look.shadows = false;
  options.picture.quality.occlusion_rays = 0;
  options.picture.look.ground = false;
  const Image none = render(caster, options);
  double off = 0, all = 0;
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
    off += std::abs(quick.pixels[i][1] - exact.pixels[i][1]);
    all += std::abs(none.pixels[i][1] - exact.pixels[i][1]);
  }
  EXPECT_LT(off, 0.15 * all);
  // The silhouette is the same in all cases.
  options.picture.look.background = Background::transparent();
  const int pixels = covered(render(caster, options));
  options.plain = true;
  EXPECT_NEAR(covered(render(caster, options)), pixels, 0.03 * pixels);
}

TEST(SurfacePicture, SteadyViewsDoNotZoom) {
  const test::Spheres sphere({0.3});
  const SurfaceCaster caster(sphere, test::sphere_balls(4000, 0.3));
  std::vector<Vec3f> points = caster.balls().centers;
  points.push_back({-1, 0, 0});
  points.push_back({1, 0, 0});
  SurfaceRenderOptions options = small_surface_picture();
  options.picture.look.background = Background::transparent();
  const auto area = [&](double azimuth, bool steady) {
    options.picture.view.direction.azimuth = azimuth;
    options.picture.view.steady = steady;
    Progress progress;
    return covered(render_surface(caster, points, nullptr, options, progress));
  };
  EXPECT_GT(area(90, false), 1.3 * area(0, false));
  EXPECT_NEAR(area(90, true), area(0, true), 4);
}

TEST(SurfacePicture, RefusesBadOptions) {
  const test::Spheres sphere({1});
  const SurfaceCaster caster(sphere, test::sphere_balls(500));
  const auto refused = [&](const std::string& name, const std::function<void(SurfaceRenderOptions&)>& spoil) {
    SurfaceRenderOptions options;
    spoil(options);
    try {
      render(caster, options);
      ADD_FAILURE() << name << " accepted";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused("width", [](auto& o) { o.picture.view.width = 0; });
  refused("reflection", [](auto& o) { o.reflection = -0.1; });
  refused("transmission", [](auto& o) { o.transmission = 1.1; });
  refused("`reflection` + `transmission`", [](auto& o) { o.transmission = o.reflection = 0.6; });
  refused("refraction_index", [](auto& o) { o.refraction_index = 0.9; });
  refused("bounces", [](auto& o) { o.bounces = 0; });
  Progress progress;
  EXPECT_THROW(render_surface(caster, {}, nullptr, {}, progress), DataError);
  const std::vector<Vec3f> one(4, Vec3f{1, 2, 3});
  EXPECT_THROW(render_surface(caster, one, nullptr, {}, progress), DataError);
  progress.cancel();
  EXPECT_THROW(render_surface(caster, caster.balls().centers, nullptr, {}, progress), Cancelled);
}

}  // namespace
}  // namespace sansmesh::inline v1
