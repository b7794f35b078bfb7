#include "sansmesh/partition/global_sign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/clouds.h"

namespace sansmesh {
namespace {

std::vector<OrientedPatch> sphere_patches(std::size_t n) {
  const PointSet cloud = test::sphere(n);
  std::vector<OrientedPatch> patches;
  for (std::size_t i = 0; i < n; ++i)
    patches.push_back(
        {cloud.positions[i], cloud.normals[i] * static_cast<float>(4 * std::numbers::pi / static_cast<double>(n))});
  return patches;
}

TEST(PlaneAreaInCube, IsExactForPlanesWithKnownSections) {
  EXPECT_NEAR(plane_area_in_cube({0, 0, 0.3f}, {0, 0, 1}, {0, 0, 0}, 1), 1, 1e-5);
  EXPECT_NEAR(plane_area_in_cube({0.5f, 0.5f, 0.5f}, normalized(Vec3f{1, 1, 1}), {0, 0, 0}, 1), 0.75 * std::sqrt(3.0),
              1e-5);  // hexagon
  EXPECT_NEAR(plane_area_in_cube({1, 1, 0}, normalized(Vec3f{1, -1, 0}), {0, 0, 0}, 2), 4 * std::sqrt(2.0),
              1e-4);  // diagonal
  EXPECT_EQ(plane_area_in_cube({0, 0, 5}, {0, 0, 1}, {0, 0, 0}, 1), 0);
}

TEST(PlaneAreaInCube, CellsTileAPlane) {
  const Vec3f normal = normalized(Vec3f{0.3f, -0.5f, 0.8f});
  double fine = 0;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z)
        fine += plane_area_in_cube(
            {0.5f, 0.5f, 0.45f}, normal,
            Vec3f(0.25f * static_cast<float>(x), 0.25f * static_cast<float>(y), 0.25f * static_cast<float>(z)), 0.25f);
  EXPECT_NEAR(fine, plane_area_in_cube({0.5f, 0.5f, 0.45f}, normal, {0, 0, 0}, 1), 1e-5);
}

TEST(GlobalSign, WindingNumberIsOneInsideAndZeroOutside) {
  const GlobalSign sign(sphere_patches(5000));
  const std::vector<Vec3f> x{{0, 0, 0}, {0.5f, 0.2f, -0.3f}, {0, 0, 0.85f}, {0, 0, 1.15f}, {2, 1, 0}, {100, 0, 0}};
  std::vector<float> w(x.size());
  sign.winding_number(x, w);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(w[i], 1, 0.06) << i;
  for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(w[i], 0, 0.06) << i;
}

TEST(GlobalSign, DistanceIsRightNearTheSurfaceAndSignedEverywhere) {
  const GlobalSign sign(sphere_patches(20000));
  std::vector<Vec3f> x;
  for (const float r : {0.2f, 0.9f, 0.95f, 1.05f, 1.1f, 3.0f}) x.push_back(normalized(Vec3f{1, 2, 3}) * r);
  std::vector<float> d(x.size());
  sign.signed_distance(x, d);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(d[i] < 0, norm(x[i]) < 1) << norm(x[i]);
  EXPECT_NEAR(d[1], -0.1, 0.02);
  EXPECT_NEAR(d[2], -0.05, 0.01);
  EXPECT_NEAR(d[3], 0.05, 0.01);
  EXPECT_NEAR(d[4], 0.1, 0.02);
}

TEST(GlobalSign, GroupsAgreeWithTheSumOverAllPatches) {
  const auto patches = sphere_patches(3000);
  const GlobalSign sign(patches);
  for (const Vec3f x : {Vec3f{0.1f, 0.4f, 0.2f}, Vec3f{0, 0, 1.3f}, Vec3f{-1.5f, 0.3f, 0.4f}}) {
    double sum = 0;
    for (const OrientedPatch& p : patches) {
      const Vec3 d(p.position - x);
      sum += dot(d, Vec3(p.area)) / std::pow(squared_norm(d), 1.5);
    }
    float w = 0;
    sign.winding_number(std::span<const Vec3f>(&x, 1), std::span<float>(&w, 1));
    EXPECT_NEAR(w, sum / (4 * std::numbers::pi), 0.03);
  }
}

/// The largest gradient on lines from afar to each of the patches.
float steepest(const std::vector<OrientedPatch>& patches) {
  const GlobalSign sign(patches);
  std::vector<Vec3f> x;
  for (std::size_t i = 0; i < patches.size(); i += 37)
    for (int k = 1; k < 60; ++k)
      x.push_back(patches[i].position + normalized(patches[i].area) * (0.01f * static_cast<float>(k)));
  std::vector<float> values(x.size());
  std::vector<Vec3f> gradients(x.size());
  sign.signed_distance(x, values, gradients);
  float most = 0;
  for (const Vec3f& g : gradients) most = std::max(most, norm(g));
  return most;
}

TEST(GlobalSign, GroupsHandOverToTheirMembersGently) { EXPECT_LT(steepest(sphere_patches(3000)), 1.5f); }

TEST(GlobalSign, SmallPatchesAreNoSteps) {
  std::vector<OrientedPatch> patches = sphere_patches(3000);
  const float area = norm(patches[0].area);
  // Every 37th juts out, and hardly anything of it is left.
  for (std::size_t i = 0; i < patches.size(); i += 37)
    patches[i].position = patches[i].position * 1.15f, patches[i].area = patches[i].area * 1e-4f;
  const float alone = steepest(patches);
  for (OrientedPatch& p : patches) p.least = 0.5f * area;
  EXPECT_GT(alone, 1.5f * steepest(patches));
}

TEST(GlobalSign, WithoutPatchesEverythingIsOutside) {
  const GlobalSign sign;
  const Vec3f x{1, 2, 3};
  float w = 1;
  sign.winding_number(std::span<const Vec3f>(&x, 1), std::span<float>(&w, 1));
  EXPECT_EQ(w, 0);
}

}  // namespace
}  // namespace sansmesh
