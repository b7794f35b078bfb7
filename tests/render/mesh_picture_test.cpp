#include "sansmesh/render_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "render/picture_levels.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::brightness;
using test::levels;

RenderOptions small_picture(int width = 160, int height = 120) {
  RenderOptions options;
  options.view.width = width;
  options.view.height = height;
  options.quality.samples = 2;
  options.view.direction = {0, 0};
  return options;
}

RenderOptions cut_out(int width = 160, int height = 120) {
  RenderOptions options = small_picture(width, height);
  options.look.background = Background::transparent();
  options.look.ground = false;
  return options;
}

/// Area in pixels and centroid of non-transparent pixels.
struct Silhouette {
  double area = 0, x = 0, y = 0;
  explicit Silhouette(const Image& image) {
    for (int j = 0; j < image.height; ++j)
      for (int i = 0; i < image.width; ++i) {
        const double a = levels(image.at(i, j))[3] / 255.0;
        area += a, x += a * (i + 0.5), y += a * (j + 0.5);
      }
    x /= area, y /= area;
  }
};

/// Points of the unit sphere with normals.
TriangleMesh sphere_cloud(int count) {
  TriangleMesh cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
    cloud.vertices.push_back(Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z}));
    cloud.normals.push_back(cloud.vertices.back());
  }
  return cloud;
}

TEST(MeshPreview, SphereIsARoundDiscInTheMiddle) {
  TriangleMesh sphere = test::octasphere(5);
  for (Vec3f& v : sphere.vertices) v = v * 250.0f + Vec3f{1000, -3000, 70};
  for (const auto& [width, height] : {std::pair{160, 120}, {120, 160}}) {
    const Silhouette seen(render_mesh(sphere, cut_out(width, height)));
    EXPECT_NEAR(seen.x, width / 2.0, 0.1);
    EXPECT_NEAR(seen.y, height / 2.0, 0.1);
    // A disc that reaches up to the margin: between half and all of the shorter side.
    const double diameter = 2 * std::sqrt(seen.area / std::numbers::pi);
    EXPECT_GT(diameter, 0.8 * 120);
    EXPECT_LT(diameter, 0.95 * 120);
  }
}

TEST(MeshPreview, IsBrighterTowardsTheLight) {
  RenderOptions options = cut_out();
  for (const ViewDirection view : {ViewDirection{0, 0}, {150, 30}, {0, -90}}) {
    options.view.direction = view;
    const Image image = render_mesh(test::octasphere(4), options);
    // The key light comes from the upper left.
    EXPECT_GT(brightness(image, 65, 45), brightness(image, 95, 75) + 60);
    EXPECT_GT(brightness(image, 80, 35), brightness(image, 80, 90) + 60);
    EXPECT_GT(brightness(image, 95, 75), 100) << "shaded parts are not black";
  }
}

TEST(MeshPreview, ShadesSmoothlyUnlessAskedNotTo) {
  // The largest step between neighbours in the middle of a coarse sphere.
  const auto roughness = [](const RenderOptions& options) {
    const Image image = render_mesh(test::octasphere(3), options);
    double worst = 0;
    for (int y = 40; y < 80; ++y)
      for (int x = 60; x < 100; ++x)
        worst = std::max(worst, std::abs(brightness(image, x, y) - brightness(image, x + 1, y)));
    return worst;
  };
  RenderOptions options = cut_out();
  const double smooth = roughness(options);
  options.look.smooth = false;
  EXPECT_GT(roughness(options), 2 * smooth);
}

TEST(MeshPreview, OcclusionDarkensHollowsOnly) {
  // The hollow between three balls.
  RenderOptions options = cut_out();
  options.look.shadows = false;
  const TriangleMesh ball = test::octasphere(4);
  TriangleMesh three = test::joined(ball, ball, {1.7f, 0, 0});
  three = test::joined(three, ball, {0.85f, 1.4f, 0});
  const auto at_middle = [&](int rays) {
    options.quality.occlusion_rays = rays;
    const Image image = render_mesh(three, options);
    double sum = 0;
    for (int y = 62; y < 72; ++y) sum += brightness(image, 80, y);
    return sum / 10;
  };
  EXPECT_LT(at_middle(16), at_middle(0) - 40);

  const auto single = [&](int rays) {
    options.quality.occlusion_rays = rays;
    return brightness(render_mesh(ball, options), 80, 60);
  };
  EXPECT_NEAR(single(16), single(0), 12) << "nothing blocks the light of a lone ball";
}

TEST(MeshPreview, CastsShadowsOnItself) {
  // A small ball in front of a wall, between it and the light.
  TriangleMesh wall;
  wall.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMesh ball = test::octasphere(3);
  for (Vec3f& v : ball.vertices) v = v * 0.4f;
  const TriangleMesh scene = test::joined(wall, ball, {0, 0, 1});
  RenderOptions options = cut_out();
  options.quality.occlusion_rays = 0;
  const auto darkest = [&](bool shadows) {
    options.look.shadows = shadows;
    const Image image = render_mesh(scene, options);
    double least = 765;
    // Lower right of the ball.
    for (int y = 75; y < 110; ++y)
      for (int x = 95; x < 125; ++x)
        if (image.at(x, y)[3] == 1) least = std::min(least, brightness(image, x, y));
    return least;
  };
  EXPECT_LT(darkest(true), darkest(false) - 100);
}

TEST(MeshPreview, DoesNotDependOnThreads) {
  RenderOptions options = small_picture(230, 170);
  options.view.direction = {35, 20};
  TriangleMesh cloud = sphere_cloud(4000);
  for (std::size_t i = 0; i < cloud.vertices.size(); ++i)
    cloud.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 7), 99});
  // Duplicate points in two colours: the hit must not depend on the construction of the tree.
  cloud.vertices.insert(cloud.vertices.end(), cloud.vertices.begin(), cloud.vertices.end());
  cloud.normals.insert(cloud.normals.end(), cloud.normals.begin(), cloud.normals.end());
  cloud.colors.resize(cloud.vertices.size(), {255, 0, 0});
  for (const TriangleMesh& mesh : {test::torus_mesh(300, 150), cloud}) {
    test::expect_equal_for_any_threads([&] { return render_mesh(mesh, options).pixels; });
  }
}

TEST(MeshPreview, BackgroundsAreWhatTheySay) {
  const TriangleMesh sphere = test::octasphere(3);
  RenderOptions options = cut_out();
  Image image = render_mesh(sphere, options);
  EXPECT_EQ(image.at(0, 0)[3], 0);
  EXPECT_EQ(image.at(159, 119)[3], 0);
  EXPECT_EQ(image.at(80, 60)[3], 1);

  options.look.background = Background::solid({0.2f, 0.4f, 1.0f});
  image = render_mesh(sphere, options);
  EXPECT_EQ(levels(image.at(0, 0)), (std::array<std::uint8_t, 4>{51, 102, 255, 255}));
  EXPECT_EQ(levels(image.at(159, 60)), (std::array<std::uint8_t, 4>{51, 102, 255, 255}));

  options.look.background = Background{};
  image = render_mesh(sphere, options);
  EXPECT_EQ(image.at(0, 0)[3], 1);
  EXPECT_GT(brightness(image, 10, 60), brightness(image, 0, 0) + 15);
}

TEST(MeshPreview, GroundCatchesTheShadow) {
  const TriangleMesh sphere = test::octasphere(4);
  RenderOptions options = cut_out();
  options.view.direction = {0, 25};
  const double alone = Silhouette(render_mesh(sphere, options)).area;
  options.look.ground = true;
  const Image image = render_mesh(sphere, options);
  const Silhouette with(image);
  EXPECT_GT(with.area, 1.02 * alone);
  EXPECT_GT(with.y, 60) << "the shadow lies below";
  EXPECT_GT(image.at(80, 112)[3], 40 / 255.0);
  EXPECT_EQ(brightness(image, 80, 112), 0) << "black that lets the rest through";
  options.view.direction = {0, -25};
  EXPECT_NEAR(Silhouette(render_mesh(sphere, options)).area, alone, 0.01 * alone) << "none is seen from below";
}

TEST(MeshPreview, VertexColorsShow) {
  TriangleMesh sphere = test::octasphere(4);
  for (const Vec3f& v : sphere.vertices)
    sphere.colors.push_back(v.x < 0 ? std::array<std::uint8_t, 3>{220, 20, 20}
                                    : std::array<std::uint8_t, 3>{20, 20, 220});
  RenderOptions options = cut_out();
  Image image = render_mesh(sphere, options);
  EXPECT_GT(image.at(60, 60)[0], 2 * image.at(60, 60)[2]);
  EXPECT_GT(image.at(100, 60)[2], 2 * image.at(100, 60)[0]);
  options.look.use_colors = false;
  options.look.surface_color = {0.1f, 0.8f, 0.1f};
  image = render_mesh(sphere, options);
  for (const int x : {60, 100}) EXPECT_GT(image.at(x, 60)[1], 2 * image.at(x, 60)[0]);
}

TEST(MeshPreview, CloudsCloseToASurface) {
  const double mesh_area = Silhouette(render_mesh(test::octasphere(5), cut_out())).area;
  TriangleMesh cloud = sphere_cloud(3000);
  RenderOptions options = cut_out();
  const Image discs = render_mesh(cloud, options);
  // The camera leaves space for the discs' radius, 1.3 of the spacing.
  const double disc_area = mesh_area / std::pow(1 + 1.3 * std::sqrt(4 * std::numbers::pi / 3000), 2);
  EXPECT_NEAR(Silhouette(discs).area, disc_area, 0.02 * mesh_area);
  EXPECT_EQ(discs.at(80, 60)[3], 1);
  EXPECT_GT(brightness(discs, 65, 45), brightness(discs, 95, 75) + 60);

  cloud.normals[100] = {0, 0, 0};  // unknown
  cloud.normals[101] = {std::nanf(""), 0, 0};
  EXPECT_NEAR(Silhouette(render_mesh(cloud, options)).area, disc_area, 0.02 * mesh_area);

  cloud.normals.clear();
  const Image balls = render_mesh(cloud, options);
  EXPECT_NEAR(Silhouette(balls).area, mesh_area, 0.03 * mesh_area);

  // Small balls leave gaps.
  options.look.point_radius = 0.004;
  EXPECT_LT(Silhouette(render_mesh(cloud, options)).area, 0.2 * mesh_area);
}

TEST(MeshPreview, DrawsASinglePoint) {
  TriangleMesh point;
  point.vertices = {{5, 5, 5}};
  for (const std::optional<double> radius : {std::optional<double>{}, std::optional<double>{3.0}}) {
    RenderOptions options = cut_out();
    options.look.point_radius = radius;
    const Silhouette seen(render_mesh(point, options));
    EXPECT_GT(seen.area, 0.3 * 160 * 120);
    EXPECT_NEAR(seen.x, 80, 0.1);
  }
}

TEST(MeshPreview, LeavesOutWhatIsNotFinite) {
  const TriangleMesh sphere = test::octasphere(4);
  TriangleMesh broken = sphere;
  const auto base = static_cast<std::uint32_t>(broken.vertices.size());
  broken.vertices.push_back({std::nanf(""), 0, 0});
  broken.vertices.push_back({0, INFINITY, 0});
  broken.vertices.push_back({50, 0, 0});  // not used by drawable triangles
  broken.triangles.insert(broken.triangles.begin(), {{base, 0, 1}, {1, base + 1, base + 2}, {0, 1, base + 77}});
  EXPECT_TRUE(render_mesh(broken, cut_out()).pixels == render_mesh(sphere, cut_out()).pixels);

  TriangleMesh cloud = sphere_cloud(500), holed = cloud;
  holed.vertices.insert(holed.vertices.begin() + 20, Vec3f{0, std::nanf(""), 0});
  holed.normals.insert(holed.normals.begin() + 20, Vec3f{1, 0, 0});
  EXPECT_TRUE(render_mesh(holed, cut_out()).pixels == render_mesh(cloud, cut_out()).pixels);
}

TEST(MeshPreview, CopesWithExtremeSizes) {
  const Image usual = render_mesh(test::octasphere(3), cut_out());
  for (const float scale : {1e-30f, 1e30f}) {
    TriangleMesh mesh = test::octasphere(3);
    for (Vec3f& v : mesh.vertices) v *= scale;
    const Silhouette seen(render_mesh(mesh, cut_out()));
    EXPECT_NEAR(seen.area, Silhouette(usual).area, 20);
  }
}

TEST(MeshPreview, RefusesWhatCannotBeDrawn) {
  EXPECT_THROW(render_mesh({}), DataError);
  TriangleMesh mesh;
  mesh.vertices.assign(3, Vec3f{std::nanf(""), 0, 0});
  EXPECT_THROW(render_mesh(mesh), DataError);
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(render_mesh(mesh), DataError);
  mesh.vertices.assign(3, Vec3f{1, 2, 3});
  EXPECT_THROW(render_mesh(mesh), DataError);
}

TEST(MeshPreview, BadOptionsAreNamed) {
  const auto refused = [](const std::string& name, const std::function<void(RenderOptions&)>& spoil) {
    RenderOptions options;
    spoil(options);
    try {
      render_mesh(test::octasphere(1), options);
      ADD_FAILURE() << name << " accepted";
    } catch (const ArgumentError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused("width", [](RenderOptions& o) { o.view.width = 0; });
  refused("height", [](RenderOptions& o) { o.view.height = 20000; });
  refused("azimuth", [](RenderOptions& o) { o.view.direction.azimuth = NAN; });
  refused("elevation", [](RenderOptions& o) { o.view.direction.elevation = 91; });
  refused("field_of_view", [](RenderOptions& o) { o.view.field_of_view = 0; });
  refused("background", [](RenderOptions& o) { o.look.background = Background::solid({1, 2, 1}); });
  refused("surface_color", [](RenderOptions& o) { o.look.surface_color.z = -0.5f; });
  refused("antialiasing", [](RenderOptions& o) { o.quality.samples = 9; });
  refused("occlusion_rays", [](RenderOptions& o) { o.quality.occlusion_rays = -1; });
  refused("point_radius", [](RenderOptions& o) { o.look.point_radius = 0; });
}

TEST(MeshPreview, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_THROW(render_mesh(test::octasphere(2), small_picture(), progress), Cancelled);
}

}  // namespace
}  // namespace sansmesh::inline v1
