#include "sansmesh/partition/far/global_sign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "sansmesh/core/morton.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
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
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(w[i], 1, 0.02) << i;
  for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(w[i], 0, 0.02) << i;
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

/// Sorts patches so that neighbours in space become neighbours in the list.
std::vector<OrientedPatch> in_order(std::vector<OrientedPatch> patches) {
  const auto code = [](const OrientedPatch& p) {
    const auto cell = [](float c) { return static_cast<std::uint32_t>((c + 4) * 0x1p17f); };
    return morton_code(cell(p.position.x), cell(p.position.y), cell(p.position.z));
  };
  std::sort(patches.begin(), patches.end(),
            [&](const OrientedPatch& a, const OrientedPatch& b) { return code(a) < code(b); });
  return patches;
}

/// Stretches along the axes by `by`: the surface stays closed.
std::vector<OrientedPatch> stretched(std::vector<OrientedPatch> patches, const Vec3f& by) {
  for (OrientedPatch& p : patches)
    for (std::size_t k = 0; k < 3; ++k) p.position[k] *= by[k], p.area[k] *= by.x * by.y * by.z / by[k];
  return in_order(std::move(patches));
}

/// The sums over all patches one by one, each as a disc.
struct AllPatches {
  double winding = 0, distance = 0, closed = 0, open = 0;

  AllPatches(const std::vector<OrientedPatch>& patches, const Vec3f& x) {
    double dipole = 0, dipole_open = 0, fourth = 0, sixth = 0;
    for (const OrientedPatch& p : patches) {
      const Vec3 d(p.position - x), a(p.area);
      const double area = std::max(norm(a), static_cast<double>(p.least)), r2 = squared_norm(d) + 0.25 * area;
      dipole += dot(d, a) / std::pow(r2, 1.5), dipole_open += dot(d, a) / std::pow(r2, 3);
      fourth += area / std::pow(r2, 2), sixth += area / std::pow(r2, 3);
    }
    winding = dipole / (4 * std::numbers::pi), distance = std::sqrt(0.5 * fourth / sixth);
    closed = std::clamp(1 - 2 * winding, -1.0, 1.0) * distance, open = -dipole_open / sixth;
  }
};

/// Root mean square and largest difference.
struct FarError {
  double sum = 0, most = 0, n = 0;
  void add(double e) { sum += e * e, most = std::max(most, std::abs(e)), n += 1; }
  double mean() const { return std::sqrt(sum / n); }
};

TEST(GlobalSign, GroupsAgreeWithTheSumOverAllPatches) {
  for (const Vec3f& by : {Vec3f{1, 1, 1}, Vec3f{1, 0.5f, 0.2f}})
    for (const std::size_t n : {3000u, 20000u}) {
      SCOPED_TRACE(testing::Message() << by.z << ' ' << n);
      const auto patches = stretched(sphere_patches(n), by);
      const GlobalSign sign(patches), sheet(patches, 1, true);
      std::vector<Vec3f> x;
      for (std::size_t i = 0; i < n; i += n / 120)
        for (const float far : {-0.1f, -0.02f, 0.05f, 0.3f, 1.5f})
          x.push_back(patches[i].position + normalized(patches[i].area) * far);
      std::vector<float> w(x.size()), closed(x.size()), open(x.size());
      sign.winding_number(x, w), sign.signed_distance(x, closed), sheet.signed_distance(x, open);
      FarError of_winding, of_closed, of_open;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const AllPatches all(patches, x[i]);
        of_winding.add(static_cast<double>(w[i]) - all.winding);
        of_closed.add((static_cast<double>(closed[i]) - all.closed) / all.distance);
        of_open.add((static_cast<double>(open[i]) - all.open) / all.distance);
      }
      EXPECT_LT(of_winding.most, 0.005);
      EXPECT_LT(of_winding.mean(), 0.0015);
      EXPECT_LT(of_closed.mean(), 0.008);
      EXPECT_LT(of_open.mean(), 0.012);
    }
}

/// Largest difference from the sums over all patches, over the lines from some of the patches: of winding numbers, and
/// of distances relative to the distance.
std::array<double, 3> largest_errors(const std::vector<OrientedPatch>& patches, std::span<const std::size_t> from) {
  const GlobalSign sign(patches), sheet(patches, 1, true);
  std::array<double, 3> most{};
  for (const std::size_t i : from)
    for (int k = 1; k < 60; ++k) {
      const Vec3f x = patches[i].position + normalized(patches[i].area) * (0.05f * static_cast<float>(k));
      float w = 0, closed = 0, open = 0;
      const std::span<const Vec3f> at(&x, 1);
      sign.winding_number(at, {&w, 1}), sign.signed_distance(at, {&closed, 1}), sheet.signed_distance(at, {&open, 1});
      const AllPatches all(patches, x);
      most[0] = std::max(most[0], std::abs(static_cast<double>(w) - all.winding));
      most[1] = std::max(most[1], std::abs(static_cast<double>(closed) - all.closed) / all.distance);
      most[2] = std::max(most[2], std::abs(static_cast<double>(open) - all.open) / all.distance);
    }
  return most;
}

TEST(GlobalSign, GroupsOfFewPatchesAreNoPoints) {
  // The last group has one or two members, and one of those above it one or two groups.
  for (const std::size_t n : {17u, 18u, 65u, 66u, 73u, 145u, 513u}) {
    SCOPED_TRACE(n);
    const auto patches = in_order(sphere_patches(n));
    const std::array<double, 3> most = largest_errors(patches, std::array{n - 1, n - 2});
    EXPECT_LT(most[0], 0.005);
    EXPECT_LT(most[1], 0.05);
    EXPECT_LT(most[2], 0.05);
  }
}

TEST(GlobalSign, GroupsOfPatchesWiderThanTheirSpacingAreNoPoints) {
  auto patches = in_order(sphere_patches(3000));
  const float area = norm(patches[0].area);
  for (const float wider : {4.0f, 30.0f}) {
    SCOPED_TRACE(wider);
    for (OrientedPatch& p : patches) p.least = wider * area;
    const std::array<double, 3> most = largest_errors(patches, std::array{0ul, 1000ul, 2000ul});
    EXPECT_LT(most[0], 0.005);
    EXPECT_LT(most[1], 0.05);
    EXPECT_LT(most[2], 0.05);
  }
}

TEST(GlobalSign, GroupsFromAfarAreOfThirdOrder) {
  // Groups have a position, and first and second moments about it: the error falls with the cube of the distance.
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<OrientedPatch> patches;
  for (int i = 0; i < 64; ++i) {
    const Vec3f p{uniform(random), uniform(random), uniform(random)};
    const Vec3f a{uniform(random), uniform(random), uniform(random) + 2};
    patches.push_back({p, a * 0.02f});
  }
  patches = in_order(std::move(patches));
  const GlobalSign sign(patches), sheet(patches, 1, true);
  std::vector<Vec3f> directions;
  for (int i = 0; i < 200; ++i)
    directions.push_back(normalized(Vec3f{uniform(random), uniform(random), uniform(random)}));
  std::array<FarError, 3> before;
  for (const float r : {5.0f, 10.0f, 20.0f}) {
    std::array<FarError, 3> now;
    for (const Vec3f& d : directions) {
      const Vec3f x = d * r;
      float w = 0, closed = 0, open = 0;
      const std::span<const Vec3f> at(&x, 1);
      sign.winding_number(at, {&w, 1}), sign.signed_distance(at, {&closed, 1}), sheet.signed_distance(at, {&open, 1});
      const AllPatches all(patches, x);
      now[0].add((static_cast<double>(w) - all.winding) * squared_norm(Vec3(x)));  // falls as 1/r² itself
      now[1].add((static_cast<double>(closed) - all.closed) / all.distance);
      now[2].add((static_cast<double>(open) - all.open) / all.distance);
    }
    for (std::size_t k = 0; k < 3; ++k)
      if (r > 5) EXPECT_LT(now[k].mean(), before[k].mean() / 5.5) << r << ' ' << k;
    before = now;
  }
}

/// Patches of a bent open ground and of a thicket above it, whose normals are random.
std::vector<OrientedPatch> vegetation(std::size_t n) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<OrientedPatch> patches;
  const float area = 4 / static_cast<float>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float x = uniform(random), y = uniform(random);
    patches.push_back(
        {{x, y, 0.1f * std::sin(3 * x) * y}, Vec3f{-0.3f * std::cos(3 * x) * y, -0.1f * std::sin(3 * x), 1} * area});
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f p{uniform(random), uniform(random), uniform(random)}, up{0, 0, 1};
    patches.push_back({p * 0.4f + up * 0.5f, (Vec3f{uniform(random), uniform(random), uniform(random)} + up) * area});
  }
  return in_order(std::move(patches));
}

/// Points near the patches and above and below all of them.
std::vector<Vec3f> points_around(const std::vector<OrientedPatch>& patches, std::size_t stride) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<Vec3f> x;
  for (std::size_t i = 0; i < patches.size(); i += stride)
    for (const float far : {0.01f, 0.04f, 0.2f, 0.8f})
      x.push_back(patches[i].position + Vec3f{uniform(random), uniform(random), uniform(random)} * far);
  return x;
}

TEST(GlobalSign, OpenThicketsAgreeWithTheSumOverAllPatches) {
  const auto patches = vegetation(8000);
  const GlobalSign sheet(patches, 1, true);
  const std::vector<Vec3f> x = points_around(patches, 150);
  std::vector<float> open(x.size());
  std::vector<Vec3f> gradients(x.size());
  sheet.signed_distance(x, open, gradients);
  FarError of_open, of_gradient;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const AllPatches all(patches, x[i]);
    of_open.add((static_cast<double>(open[i]) - all.open) / all.distance);
    const auto k = i % 3;
    const auto step = static_cast<float>(1e-3 * all.distance);
    Vec3f ahead = x[i], behind = x[i];
    ahead[k] += step, behind[k] -= step;
    const double slope = (AllPatches(patches, ahead).open - AllPatches(patches, behind).open) /
                         static_cast<double>(ahead[k] - behind[k]);
    of_gradient.add(static_cast<double>(gradients[i][k]) - slope);
  }
  EXPECT_LT(of_open.mean(), 0.004);
  EXPECT_LT(of_open.most, 0.04);
  EXPECT_LT(of_gradient.mean(), 0.02);
}

TEST(GlobalSign, RoughDistancesOfThicketsKnowTheirError) {
  // A sign is clear if the rough distance exceeds a share of its bound; errors must stay below that.
  const auto patches = vegetation(8000);
  const GlobalSign sheet(patches, 1, true), solid(patches);
  const std::vector<Vec3f> x = points_around(patches, 100);
  std::vector<float> rough(x.size()), most(x.size());
  sheet.rough_distance(x, rough, most);
  FarError error;
  std::size_t wrong = 0, clear = 0, facing = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const AllPatches all(patches, x[i]);
    error.add((static_cast<double>(rough[i]) - all.open) / static_cast<double>(most[i]));
    facing += std::abs(rough[i]) > most[i] * 1.0001f;
    if (std::abs(rough[i]) < 0.3f * most[i]) continue;
    ++clear, wrong += (rough[i] < 0) != (all.open < 0);
  }
  EXPECT_LT(error.mean(), 0.03);
  EXPECT_LT(error.most, 0.25);
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(facing, 0u);
  EXPECT_GT(clear, x.size() / 2);
  solid.rough_distance(x, rough, most);  // unknown: no share of the bound is exceeded
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_FALSE(std::abs(rough[i]) > 0.3f * most[i]);
}

/// Largest gradient on lines from afar to each of the patches.
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
  // Every 37th patch protrudes and has hardly any area.
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
}  // namespace sansmesh::inline v1
