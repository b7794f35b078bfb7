#include "sansmesh/surface/curvature_colors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sansmesh/error.h"
#include "surface/curvature_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::Curved;
using test::curved_cloud;
using Quantity = CurvatureQuantity;

TEST(CurvatureColors, MapIsBlueWhiteRedAndEven) {
  const Vec3f blue = diverging_color(-1), white = diverging_color(0), red = diverging_color(1);
  EXPECT_GT(blue.z, blue.x + 0.4f);
  EXPECT_GT(red.x, red.z + 0.4f);
  EXPECT_GT(std::min({white.x, white.y, white.z}), 0.95f);
  EXPECT_LT(std::max({white.x, white.y, white.z}) - std::min({white.x, white.y, white.z}), 0.01f);
  EXPECT_EQ(diverging_color(-7), blue);
  EXPECT_EQ(diverging_color(std::numeric_limits<float>::infinity()), red);
  EXPECT_EQ(diverging_color(std::numeric_limits<float>::quiet_NaN()), white);
  // Luminance decreases equally from the middle to both ends.
  const auto luminance = [](const Vec3f& c) {
    const auto linear = [](float v) { return std::pow(v, 2.2f); };
    return 0.2126f * linear(c.x) + 0.7152f * linear(c.y) + 0.0722f * linear(c.z);
  };
  for (float t = 0; t < 0.99f; t += 0.1f) {
    EXPECT_LT(luminance(diverging_color(t + 0.1f)), luminance(diverging_color(t)));
    EXPECT_LT(luminance(diverging_color(-t - 0.1f)), luminance(diverging_color(-t)));
    EXPECT_NEAR(luminance(diverging_color(t)), luminance(diverging_color(-t)), 0.06f);
  }
}

TEST(CurvatureColors, OfATorusAreRedOutsideAndBlueInside) {
  const auto cloud = curved_cloud(Curved::torus, 10000, 0, 1);
  Progress progress;
  for (const Quantity quantity : {Quantity::gaussian, Quantity::k2}) {
    CurvatureColorOptions options;
    options.quantity = quantity;
    const CurvatureColors colors(cloud.points, options, progress);
    EXPECT_GT(colors.range(), 0.5);
    const std::vector<Vec3> x{{1.4, 0, 0}, {0, -0.6, 0}, {0.0, 1.0, 0.4}};
    std::vector<Vec3f> found(3);
    colors.evaluate(x, found);
    EXPECT_GT(found[0].x, found[0].z + 0.1f);
    EXPECT_GT(found[1].z, found[1].x + 0.2f);
    EXPECT_NEAR(found[2].x, found[2].z, 0.15f);  // flat in one direction at the top
    EXPECT_GT(found[2].y, 0.8f);
  }
}

TEST(CurvatureColors, FollowTheGivenRange) {
  const auto cloud = curved_cloud(Curved::sphere, 3000, 0, 2);
  Progress progress;
  CurvatureColorOptions options;
  options.range = 2;
  const CurvatureColors colors(cloud.points, options, progress);
  std::vector<Vec3> x;
  for (const Vec3f& p : cloud.points.positions) x.emplace_back(p);
  std::vector<Vec3f> found(x.size());
  colors.evaluate(x, found);
  for (const Vec3f& c : found) EXPECT_LT(norm(c - diverging_color(0.5f)), 0.02f);
}

TEST(CurvatureColors, OfPlanesAreWhiteAndOfNothingGrey) {
  Progress progress;
  PointSet plane;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) {
      plane.positions.push_back({static_cast<float>(x), static_cast<float>(y), 0});
      plane.normals.push_back({0, 0, 1});
    }
  const std::vector<Vec3> x{{3, 4, 0}};
  std::vector<Vec3f> found(1);
  CurvatureColors(plane, {}, progress).evaluate(x, found);
  EXPECT_GT(found[0].y, 0.95f);
  CurvatureColors(PointSet{}, {}, progress).evaluate(x, found);
  EXPECT_EQ(found[0].x, found[0].z);
  plane.normals.clear();
  EXPECT_THROW(CurvatureColors(plane, {}, progress), DataError);
  CurvatureColorOptions bad;
  bad.range = -1;
  EXPECT_THROW(CurvatureColors(plane, bad, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
