// Tests of pictures of objects: choices, notes, errors. The pictures are tested in tests/render and tests/cli.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/functions.h"
#include "sansmesh/pictures.h"
#include "support/clouds.h"
#include "support/mesh_shapes.h"
#include "support/notes.h"

namespace sansmesh::test {
namespace {

PictureOptions small(PictureOptions options = {}) {
  options.look.picture.view.width = 64, options.look.picture.view.height = 48, options.look.picture.quality.samples = 1;
  return options;
}

PictureObject ball(const std::string& name = "ball.ply") {
  return {.name = name, .title = name, .points = ball_mesh(4)};
}

PictureObject cloud_object() { return {.name = "cloud.ply", .title = "cloud", .points = sphere(800)}; }

PictureObject function_object() {
  Progress progress;
  PictureObject object{.name = "ball.smf"};
  object.function = fit_function(sphere(1500), {}, progress).function;
  return object;
}

struct Pictures {
  std::vector<Image> images;
  RenderResult result;
};

Pictures pictures_of(std::vector<PictureObject> objects, const PictureOptions& options) {
  Pictures made;
  Progress progress;
  made.result = render(
      std::move(objects), options,
      [&](std::size_t frame, const Image& image, const RenderOptions&) {
        EXPECT_EQ(frame, made.images.size());
        made.images.push_back(image);
      },
      progress);
  return made;
}

std::string refusal(std::vector<PictureObject> objects, const PictureOptions& options) {
  try {
    pictures_of(std::move(objects), options);
  } catch (const ArgumentError& error) {
    return error.what();
  }
  return "drawn";
}

TEST(RenderJob, DrawsEachKindInItsWay) {
  const Pictures mesh = pictures_of({ball()}, small());
  ASSERT_EQ(mesh.images.size(), 1u);
  EXPECT_EQ(mesh.images[0].width, 64);
  EXPECT_FALSE(mesh.result.report.surface);
  EXPECT_TRUE(mesh.result.report.objects.empty());
  const Pictures function = pictures_of({function_object()}, small());
  ASSERT_TRUE(function.result.report.surface);
  EXPECT_EQ(function.result.report.surface->method, "partition");
  ASSERT_TRUE(function.result.report.rays);
  EXPECT_GT(function.result.report.rays->hits, 100u);
  PictureOptions splats = small();
  splats.splats = 3000;
  EXPECT_NEAR(static_cast<double>(*pictures_of({cloud_object()}, splats).result.report.splats), 3000, 500);
  PictureOptions turning = small();
  turning.frames = 3;
  const Pictures turned = pictures_of({ball()}, turning);
  EXPECT_EQ(turned.images.size(), 3u);
  EXPECT_EQ(turned.result.report.objects.size(), 1u);
}

TEST(RenderJob, ObjectsHaveColorsOfTheirOwnAndAList) {
  PictureObject lines{.name = "lines.vtp"};
  lines.points.positions = {{-2, 0, 0}, {2, 0, 0}};
  lines.lines.positions = lines.points.positions;
  lines.lines.offsets = {0, 2};
  PictureOptions options = small();
  options.look.picture.view.width = 400, options.look.picture.view.height = 120;
  options.colors = {"red"};
  options.names = {"first"};
  const Pictures made = pictures_of({ball(), function_object(), lines}, options);
  EXPECT_EQ(made.images[0].width, 400) << "with the list";
  const auto& objects = made.result.report.objects;
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[0].kind, ObjectKind::mesh);
  EXPECT_EQ(objects[0].title, "first");
  EXPECT_EQ(objects[1].kind, ObjectKind::function);
  EXPECT_EQ(objects[1].title, "ball.smf");
  EXPECT_EQ(objects[2].kind, ObjectKind::lines);
  EXPECT_NE(objects[1].color, objects[2].color);
}

TEST(RenderJob, LinesOfACloudAreThoseOfItsSurface) {
  PictureOptions options = small();
  options.look.picture.look.lines = PictureLook::Lines::only;
  EXPECT_TRUE(pictures_of({cloud_object()}, options).result.report.surface);
  EXPECT_FALSE(pictures_of({ball()}, options).result.report.surface);
  // Points of a plane form no surface.
  PictureObject plane{.name = "plane.xyz"};
  for (int i = 0; i < 400; ++i)
    plane.points.positions.push_back(
        {static_cast<float>(i % 20), std::floor(0.05f * static_cast<float>(i) + 0.001f), 0});
  EXPECT_EQ(pictures_of({plane}, options).images.size(), 1u);
}

TEST(RenderJob, NotesWhatIsLeftOut) {
  PictureOptions options = small();
  options.cloud.remove_outliers = true;
  PictureObject stray = cloud_object();
  stray.points = joined(sphere(2000), sphere(10), 0.05f, {4, 0, 0});
  const RenderResult made = pictures_of({stray}, options).result;
  ASSERT_TRUE(has_note(made.notes, "outliers"));
  EXPECT_EQ(made.notes[0].of, "cloud.ply");
}

TEST(RenderJob, ColorsByAttributeHaveABar) {
  PictureObject high = ball();
  std::vector<float> heights;
  for (const Vec3f& p : high.points.positions) heights.push_back(p.y);
  high.points.attributes.set("height", heights);
  PictureOptions options = small();
  options.look.picture.view.width = 240, options.look.picture.view.height = 150;
  options.color_by = "height";
  EXPECT_EQ(pictures_of({high}, options).images[0].width, 240);
  options.bar = false;
  EXPECT_EQ(pictures_of({high}, options).images[0].width, 240);
  options.bar = true, options.look.picture.view.width = 120;
  EXPECT_NE(refusal({high}, options).find("`bar = false`"), std::string::npos);
  options.color_by = "depth";
  Progress progress;
  EXPECT_THROW(pictures_of({high}, options), DataError);
}

TEST(RenderJob, RefusesWhatWouldNotBeHeeded) {
  const auto names = [&](const char* field, std::vector<PictureObject> objects, const PictureOptions& options) {
    EXPECT_NE(refusal(std::move(objects), options).find("`" + std::string(field)), std::string::npos)
        << field << ": " << refusal({ball()}, options);
  };
  PictureOptions o = small();
  o.look.plain = true;
  names("quick", {ball()}, o);
  o = small(), o.look.picture.look.smooth = false;
  names("smooth = false", {function_object()}, o);
  names("smooth = false", {cloud_object()}, o);
  o = small(), o.look.picture.look.point_radius = 0.1;
  names("point_radius", {ball()}, o);
  o = small(), o.names = {"one"};
  names("name", {ball()}, o);
  o = small(), o.colors = {"red", "blue"};
  names("color", {ball()}, o);
  o.colors = {"redd"};
  names("color", {ball()}, o);
  o = small(), o.opacities = {2};
  names("opacity", {ball()}, o);
  o = small(), o.color_by = "mean";
  names("color_by", {ball()}, o);
  names("color_by", {ball(), cloud_object()}, o);
  o = small(), o.unit = "mm";
  names("unit", {ball()}, o);
  o = small(), o.color_range = {1, 0}, o.color_by = "height";
  names("color_range", {ball()}, o);
  o = small(), o.rays = RayStart::march;
  names("rays", {cloud_object()}, o);
  o = small(), o.surface = SurfaceOptions{};
  names("surface", {function_object()}, o);
  names("surface", {cloud_object(), cloud_object()}, o);
  o = small(), o.frames = 0;
  names("frames", {ball()}, o);
  o = small(), o.opacities = {0.5}, o.look.picture.look.lines = PictureLook::Lines::over;
  names("lines", {ball()}, o);
  o = small(), o.look.picture.look.lines = PictureLook::Lines::only, o.color_by = "height";
  names("color_by", {ball()}, o);
  names("color_by", {}, small({.color_by = "height", .colors = {"red"}}));
}

}  // namespace
}  // namespace sansmesh::test
