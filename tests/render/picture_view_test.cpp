// Views of every kind of content: two balls of radius 1, the right one farther away.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "render/analytic_volumes.h"
#include "sansmesh/error.h"
#include "sansmesh/render/annotate/picture_crop.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/render_options.h"
#include "support/any_threads.h"
#include "support/mesh_shapes.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kPictureWidth = 128, kPictureHeight = 96;
const Vec3 kNear{-2, 0, 0}, kFar{2, 0.5, -6};

RenderOptions front_view() {
  RenderOptions options;
  options.view.width = kPictureWidth, options.view.height = kPictureHeight;
  options.quality.samples = 2;
  options.view.direction = {0, 0};
  options.look.background = Background::transparent();
  options.look.ground = options.look.shadows = false;
  options.quality.occlusion_rays = 0;
  return options;
}

double to_balls(const Vec3& x) { return std::min(norm(x - kNear), norm(x - kFar)) - 1; }
Vec3 from_ball(const Vec3& x) { return normalized(x - (norm(x - kNear) < norm(x - kFar) ? kNear : kFar)); }

class TwoBalls : public ScalarField {
 public:
  Box3 bounds() const override { return {{-4, -4, -9}, {4, 4, 3}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = to_balls(x[i]);
      if (!gradients.empty()) gradients[i] = from_ball(x[i]);
    }
  }
};

TriangleMesh ball_meshes() {
  TriangleMesh none;
  return test::joined(test::joined(none, test::octasphere(4), Vec3f(kNear)), test::octasphere(4), Vec3f(kFar));
}

using Draw = std::function<Image(const RenderOptions&)>;

/// The same balls as triangles, as a cloud, as a surface without a mesh, as an iso-surface of a volume, and as two
/// meshes.
std::vector<std::pair<std::string, Draw>> all_kinds() {
  const auto mesh = [](const RenderOptions& o) { return render_mesh(ball_meshes(), o); };
  const auto cloud = [](const RenderOptions& o) {
    TriangleMesh points = ball_meshes();
    points.normals.resize(points.vertices.size());
    for (std::size_t v = 0; v < points.vertices.size(); ++v)
      points.normals[v] = Vec3f(from_ball(Vec3(points.vertices[v])));
    points.triangles.clear();
    RenderOptions own = o;
    own.look.point_radius = 0.08;
    return render_mesh(points, own);
  };
  const auto surface = [](const RenderOptions& o) {
    const TwoBalls field;
    BallUnion balls;
    balls.centers = ball_meshes().vertices;
    balls.radii.assign(balls.centers.size(), 0.3f);
    SurfaceRenderOptions own;
    own.picture = o;
    Progress progress;
    return render_surface(SurfaceCaster(field, balls), balls.centers, nullptr, own, progress);
  };
  const auto volume = [](const RenderOptions& o) {
    test::FormulaVolume field;
    field.value = to_balls, field.gradient = from_ball;
    field.box = {{-4, -2, -8}, {4, 2, 2}};
    VolumePictureOptions own;
    own.picture = o;
    own.opacity_factor = 0, own.clip_faces = false;
    own.isos = {{0, Vec3f{1, 1, 1}, 1}};
    own.transfer = TransferFunction{{}, {{-1, {}}, {8, {}}}, {{-1, 0}, {8, 0}}};
    VolumeSubject subject;
    subject.field = &field;
    Progress progress;
    return render_volume(subject, own, progress);
  };
  const auto objects = [](const RenderOptions& o) {
    TriangleMesh near = test::octasphere(4), far = near;
    near.origin = kNear, far.origin = kFar;
    const std::vector<SceneFactory> both = {scene_factory(near, o), scene_factory(far, o)};
    std::vector<Vec3> places;
    for (const Vec3f& p : ball_meshes().vertices) places.emplace_back(p);
    Progress progress;
    return render_surfaces(both, places, false, o, progress);
  };
  return {{"mesh", mesh}, {"cloud", cloud}, {"surface", surface}, {"volume", volume}, {"objects", objects}};
}

/// Number of covered pixels, and their centroid, in the columns from `first` to `last` (exclusive).
struct Spot {
  double area = 0, x = 0, y = 0;
  explicit Spot(const Image& image, int first = 0, int last = kPictureWidth) {
    for (int v = 0; v < image.height; ++v)
      for (int u = first; u < std::min(last, image.width); ++u) {
        const double a = static_cast<double>(image.at(u, v)[3]);
        area += a, x += a * (u + 0.5), y += a * (v + 0.5);
      }
    x /= area, y /= area;
  }
};

TEST(PictureView, OrthographicSizesDoNotDependOnTheDepth) {
  for (const auto& [name, draw] : all_kinds()) {
    SCOPED_TRACE(name);
    RenderOptions options = front_view();
    const Image deep = draw(options);
    EXPECT_GT(Spot(deep, 0, kPictureWidth / 2).area, 1.3 * Spot(deep, kPictureWidth / 2).area);
    options.view.orthographic = true;
    const Image flat = draw(options);
    const Spot near(flat, 0, kPictureWidth / 2), far(flat, kPictureWidth / 2);
    EXPECT_GT(near.area, 200);
    EXPECT_NEAR(near.area / far.area, 1, 0.03);
    // Discs of the same size at the ends of the framed content, one of them half a radius higher.
    const double radius = std::sqrt(near.area / 3.14159265);
    EXPECT_NEAR(far.x - near.x, 4 * radius, 0.06 * radius);
    EXPECT_NEAR(near.y - far.y, 0.5 * radius, 0.06 * radius);
  }
}

TEST(PictureView, ThePlaceLookedAtIsInTheMiddle) {
  SANSMESH_NOT_SANITIZED("judges pictures; others draw them, too");
  for (const auto& [name, draw] : all_kinds())
    for (const bool parallel : {false, true}) {
      SCOPED_TRACE(name + (parallel ? ", orthographic" : ""));
      RenderOptions options = front_view();
      options.view.orthographic = parallel;
      options.view.look_at = kFar;
      options.view.zoom = 2.5;  // the other one is outside
      const Spot far(draw(options));
      EXPECT_NEAR(far.x, kPictureWidth / 2.0, 1);
      EXPECT_NEAR(far.y, kPictureHeight / 2.0, 1);
      options.view.zoom = 0.4;
      options.view.clip_box = Box3{kFar - Vec3{2, 2, 2}, kFar + Vec3{2, 2, 2}};
      const Image alone = draw(options);
      options.view.zoom = 0.8;
      EXPECT_NEAR(Spot(draw(options)).area / Spot(alone).area, 4, 0.12) << "twice as large";
    }
}

TEST(PictureView, ABallAroundThePlaceFillsThePicture) {
  SANSMESH_NOT_SANITIZED("judges pictures; others draw them, too");
  for (const auto& [name, draw] : all_kinds())
    for (const bool parallel : {false, true}) {
      SCOPED_TRACE(name + (parallel ? ", orthographic" : ""));
      RenderOptions options = front_view();
      options.view.orthographic = parallel;
      options.view.look_at = kFar;
      options.view.look_radius = 1.0;
      const PixelBox seen = picture_content(draw(options), options, 0);
      EXPECT_NEAR(seen.height, kPictureHeight * (1 - 0.13), 3);
      EXPECT_NEAR(seen.top, 0.065 * kPictureHeight, 2);
    }
}

TEST(PictureView, OnlyWhatLiesInTheBoxIsShown) {
  for (const auto& [name, draw] : all_kinds()) {
    SCOPED_TRACE(name);
    RenderOptions options = front_view();
    options.view.orthographic = true;
    options.view.look_at = Vec3{0, 0.25, -3};
    options.view.look_radius = 4.0;  // the scale does not depend on the box
    // The left half of the nearer ball, and nothing of the other.
    options.view.clip_box = Box3{{-4, -3, -3}, {kNear.x, 3, 3}};
    const Spot half(draw(options));
    options.view.clip_box = Box3{{-4, -3, -3}, {0, 3, 3}};
    const Image near = draw(options);
    const Spot whole(near);
    EXPECT_GT(whole.area, 200);
    EXPECT_NEAR(half.area / whole.area, 0.5, 0.03);
    for (int v = 0; v < near.height; ++v) ASSERT_EQ(near.at(kPictureWidth * 3 / 4, v)[3], 0) << "the ball on the right";
    options.view.clip_box = Box3{{100, 100, 100}, {101, 101, 101}};
    EXPECT_THROW(draw(options), ArgumentError);
  }
}

TEST(PictureView, ABoxAsLargeAsTheVolumeCutsNothing) {
  test::FormulaVolume field;
  field.value = to_balls, field.gradient = from_ball;
  field.box = {{-4, -2, -8}, {4, 2, 2}};
  VolumePictureOptions options;
  options.picture = front_view();
  options.isos = {{0, Vec3f{1, 1, 1}, 1}};
  options.opacity_factor = 0;
  options.transfer = TransferFunction{{}, {{-1, {}}, {8, {}}}, {{-1, 0}, {8, 1}}};
  VolumeSubject subject;
  subject.field = &field;
  Progress progress;
  const Image whole = render_volume(subject, options, progress);
  options.picture.view.clip_box = field.box;
  EXPECT_TRUE(render_volume(subject, options, progress).pixels == whole.pixels);
}

TEST(PictureView, WhatIsCutOpenShowsItsInside) {
  // The front of the nearer ball is cut off: the inside of its back is visible, farther away.
  TriangleMesh ball = test::octasphere(4);
  RenderOptions options = front_view();
  options.view.orthographic = true;
  const Image whole = render_mesh(ball, options);
  options.view.clip_box = Box3{{-2, -2, -2}, {2, 2, 0}};
  const Image back = render_mesh(ball, options);
  const Spot a(whole), b(back);
  EXPECT_NEAR(a.area, b.area, 0.02 * a.area);
  // Lit from the upper left: the ball is bright there, its inside at the lower right.
  const int x = static_cast<int>(a.x), y = static_cast<int>(a.y), d = kPictureHeight / 5;
  EXPECT_GT(whole.at(x - d, y - d)[1], whole.at(x + d, y + d)[1] + 0.1f);
  EXPECT_LT(back.at(x - d, y - d)[1], back.at(x + d, y + d)[1] - 0.1f);
}

TEST(PictureView, ViewsFromADirectionLookAgainstIt) {
  for (const UpAxis up : {UpAxis::y, UpAxis::z})
    for (const Vec3& d : {Vec3{1, 2, 3}, {-1, 0.5, 0}, {0, 0, -2}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}) {
      const std::vector<Vec3f> one{{0, 0, 0}};
      const Camera camera = frame_camera(one, view_from(d, up), up, 30, 1, 0, 1);
      EXPECT_LT(norm(Vec3(camera.backward) - normalized(d)), 1e-6);
    }
}

TEST(PictureView, IsTheSameForAnyThreads) {
  RenderOptions options = front_view();
  options.view.orthographic = options.look.ground = options.look.shadows = true;
  options.view.direction = {35, 20};
  options.view.clip_box = Box3{{-4, -0.5, -9}, {4, 3, 3}};
  for (const auto& [name, draw] : all_kinds()) {
    SCOPED_TRACE(name);
    test::expect_equal_for_any_threads([&] { return draw(options).pixels; });
  }
}

TEST(PictureView, BadOnesAreNamed) {
  const auto fails = [](auto change) {
    RenderOptions options;
    change(options);
    EXPECT_THROW(options.validate(), ArgumentError);
  };
  fails([](RenderOptions& o) { o.view.zoom = 0; });
  fails([](RenderOptions& o) { o.view.look_radius = 1.0; });
  fails([](RenderOptions& o) { o.annotation.scale_bar = "mm"; });
  fails([](RenderOptions& o) { o.view.look_at = Vec3{NAN, 0, 0}; });
  fails([](RenderOptions& o) { o.view.clip_box = Box3{{0, 0, 0}, {1, 0, 1}}; });
}

// Both sides of open scans are visible.
TEST(CloudPicture, IsLitFromBehindAsSheetsAre) {
  TriangleMesh points;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) points.vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0});
  RenderOptions o = front_view();
  points.normals.assign(points.vertices.size(), {0, 0, 1});
  const Image front = render_mesh(points, o);
  points.normals.assign(points.vertices.size(), {0, 0, -1});
  const Rgba behind = render_mesh(points, o).at(kPictureWidth / 2, kPictureHeight / 2);
  EXPECT_NEAR(behind[1], front.at(kPictureWidth / 2, kPictureHeight / 2)[1], 0.02);
}

TEST(PictureCrop, ContentIsFoundOnAnyBackground) {
  TriangleMesh ball = test::octasphere(4);
  for (const auto background : {Background{}, Background::solid({0, 0, 0}), Background::transparent()}) {
    RenderOptions options = front_view();
    options.look.background = background;
    options.view.orthographic = true;
    const Image image = render_mesh(ball, options);
    const PixelBox box = picture_content(image, options, 0);
    EXPECT_NEAR(box.width, 0.87 * kPictureHeight, 2);
    EXPECT_NEAR(box.height, 0.87 * kPictureHeight, 2);
    EXPECT_NEAR(box.left + 0.5 * box.width, kPictureWidth / 2.0, 1);
    const Image part = cropped(image, box);
    EXPECT_EQ(part.width, box.width);
    EXPECT_EQ(part.at(3, 5), image.at(box.left + 3, box.top + 5));
  }
  Image small(4, 4);
  EXPECT_THROW(cropped(small, {0, 0, 5, 1}), ArgumentError);
  EXPECT_EQ(picture_content(Image(4, 3, Rgba{0, 0, 0, 0}), front_view(), 1), (PixelBox{0, 0, 4, 3}));
}

TEST(ViewOptions, ANamedViewGoesBeforeAngles) {
  ViewOptions options{.azimuth = 10.0, .z_up = true};
  RenderOptions look;
  EXPECT_EQ(options.applied_to(look).view.direction.azimuth, 10);
  EXPECT_EQ(options.applied_to(look).view.direction.elevation, look.view.direction.elevation);
  EXPECT_EQ(options.applied_to(look).view.up, UpAxis::z);
  options.view = NamedView::back;
  EXPECT_EQ(options.applied_to(look).view.direction.azimuth, 180);
  EXPECT_TRUE(options.has_direction());
  EXPECT_FALSE(ViewOptions{}.has_direction());
}

TEST(ViewOptions, CropIsABoxOrWhatIsNotBackground) {
  PictureCrop crop;
  option_of_text("1, 2,30,40", crop);
  EXPECT_EQ(crop.box, (PixelBox{1, 2, 30, 40}));
  EXPECT_EQ(text_of_option(crop), "1,2,30,40");
  option_of_text("content", crop);
  EXPECT_FALSE(crop.box);
  for (const char* text : {"1,2,3", "1,2,3,4,5", "1,2,0,4", "-1,2,3,4", "1,2,3,4x", "all", ""})
    EXPECT_THROW(option_of_text(text, crop), ArgumentError) << text;
  RenderOptions look;
  look.view.width = 40, look.view.height = 30;
  const ViewOptions content{.crop = PictureCrop{}}, box{.crop = PictureCrop{PixelBox{5, 5, 10, 8}}};
  EXPECT_NO_THROW(content.check_frames(false));
  EXPECT_THROW(content.check_frames(true), ArgumentError);
  EXPECT_NO_THROW(box.check_frames(true));
  EXPECT_EQ(box.part_of(Image(40, 30, {1, 1, 1, 1}), look).width, 10);
  EXPECT_THROW((ViewOptions{.crop = PictureCrop{PixelBox{35, 5, 10, 8}}}.applied_to(look)), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
