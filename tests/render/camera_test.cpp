#include "sansmesh/render/scene/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Position in the picture, −1..1, and distance in front of the camera.
Vec3 project(const Camera& camera, const Vec3f& p) {
  const Vec3f d = p - camera.position;
  const double depth = -dot(d, camera.backward);
  return {dot(d, camera.right) / depth / camera.half_width, dot(d, camera.up) / depth / camera.half_height, depth};
}

std::vector<Vec3f> random_points(int count, const Vec3f& size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    points.push_back({size.x * x + 3, size.y * y - 2, size.z * z + 1});
  }
  return points;
}

TEST(Camera, FillsThePictureUpToTheMargin) {
  const std::vector<Vec3f> points = random_points(200, {2, 1, 0.5f});
  for (const UpAxis up : {UpAxis::y, UpAxis::z})
    for (const double aspect : {0.5, 1.0, 1.6})
      for (const ViewDirection view : {ViewDirection{0, 0}, {35, 20}, {200, -50}, {10, 90}, {0, -90}}) {
        const Camera camera = frame_camera(points, view, up, 40, aspect, 0.1);
        Vec3 low{9, 9, 9}, high{-9, -9, -9};
        for (const Vec3f& p : points) {
          const Vec3 q = project(camera, p);
          ASSERT_GT(q.z, 0);
          for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], q[k]), high[k] = std::max(high[k], q[k]);
        }
        const double reach = std::max({-low.x, -low.y, high.x, high.y});
        EXPECT_NEAR(reach, 0.9, 1e-4);
        // In the limiting direction, both sides touch the margin.
        EXPECT_NEAR(std::max(high.x - low.x, high.y - low.y), 1.8, 1e-4);
      }
}

TEST(Camera, LeavesRoomForBalls) {
  const std::vector<Vec3f> one{{0, 0, 0}};
  const Camera camera = frame_camera(one, {0, 0}, UpAxis::y, 60, 1, 0, 1);
  // The cone of 60° around a unit ball has its tip two radii away.
  EXPECT_NEAR(camera.position.z, 2, 1e-5);
  EXPECT_NEAR(camera.position.x, 0, 1e-5);
}

TEST(Camera, NamedViewsLookFromWhereTheySay) {
  const std::vector<Vec3f> points = random_points(10, {1, 1, 1});
  const auto from = [&](const char* name, UpAxis up) {
    return frame_camera(points, named_view(name), up, 30, 1, 0.1).backward;
  };
  const auto expect_near = [](const Vec3f& a, const Vec3f& b) { EXPECT_LT(norm(a - b), 1e-6f); };
  expect_near(from("front", UpAxis::y), {0, 0, 1});
  expect_near(from("back", UpAxis::y), {0, 0, -1});
  expect_near(from("right", UpAxis::y), {1, 0, 0});
  expect_near(from("left", UpAxis::y), {-1, 0, 0});
  expect_near(from("top", UpAxis::y), {0, 1, 0});
  expect_near(from("bottom", UpAxis::y), {0, -1, 0});
  expect_near(from("front", UpAxis::z), {0, -1, 0});
  expect_near(from("right", UpAxis::z), {1, 0, 0});
  expect_near(from("top", UpAxis::z), {0, 0, 1});
  try {
    named_view("sideways");
    FAIL() << "no error";
  } catch (const ArgumentError& error) {
    EXPECT_NE(std::string(error.what()).find("sideways"), std::string::npos);
  }
}

TEST(Camera, TurntableGoesAroundOnce) {
  const std::vector<ViewDirection> views = turntable({35, 20}, 8);
  ASSERT_EQ(views.size(), 8u);
  EXPECT_EQ(views[0].azimuth, 35);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(views[i].elevation, 20);
    const double step = views[(i + 1) % 8].azimuth - views[i].azimuth;
    EXPECT_NEAR(std::remainder(step, 360.0), 45, 1e-9);
  }
  EXPECT_THROW(turntable({0, 0}, 0), ArgumentError);
}

TEST(Camera, AxesAreOrthonormalAndRightHanded) {
  const std::vector<Vec3f> points = random_points(10, {1, 1, 1});
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const Camera c = frame_camera(points, {123, 31}, up, 30, 1.3, 0.1);
    EXPECT_LT(norm(cross(c.right, c.up) - c.backward), 1e-6f);
    EXPECT_NEAR(norm(c.right), 1, 1e-6);
    EXPECT_NEAR(norm(c.up), 1, 1e-6);
    EXPECT_GT(up == UpAxis::z ? c.up.z : c.up.y, 0.5f);
  }
}

TEST(Camera, LayersAreLookedAtStraight) {
  const auto view_of = [](const Vec3& size, UpAxis up) {
    return view_of_layer(Box3{{1, 2, 3}, Vec3{1, 2, 3} + size}, up);
  };
  EXPECT_FALSE(view_of({1, 1, 1}, UpAxis::y));
  EXPECT_FALSE(view_of({1, 0.1, 0.1}, UpAxis::y));
  for (const UpAxis up : {UpAxis::y, UpAxis::z})
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 size{3, 3, 3};
      size[k] = 0.01;
      const auto view = view_of(size, up);
      ASSERT_TRUE(view.has_value());
      const std::vector<Vec3f> corners = {{0, 0, 0}, Vec3f(size)};
      const Camera camera = frame_camera(corners, *view, up, 30, 1, 0.1);
      EXPECT_NEAR(std::abs(camera.backward[k]), 1, 1e-6) << k;
    }
}

}  // namespace
}  // namespace sansmesh::inline v1
