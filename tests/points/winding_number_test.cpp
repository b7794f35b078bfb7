// The winding number of a cloud's patches: 1 inside, 0 outside, whatever the sampling.
#include "sansmesh/points/winding_number.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "support/clouds.h"

namespace sansmesh {
namespace {

std::vector<float> evaluate(const WindingNumber& winding, const std::vector<Vec3f>& x) {
  std::vector<float> w(x.size(), -1.0f);
  winding.evaluate(x, w);
  return w;
}

std::vector<Vec3f> random_points(std::size_t n, float reach, unsigned seed = 3) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-reach, reach);
  std::vector<Vec3f> x(n);
  for (Vec3f& p : x) p = {uniform(generator), uniform(generator), uniform(generator)};
  return x;
}

double total(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

OrientedPatches patches_of(const PointSet& cloud, double cell) {
  return make_patches(cloud.positions, cloud.normals, cell);
}

/// Largest |w − [‖x‖ < 1]| over points at least `gap` away from the unit sphere.
double sphere_error(const OrientedPatches& patches, double gap) {
  const std::vector<Vec3f> x = random_points(4000, 1.6f);
  const std::vector<float> w = evaluate(WindingNumber(patches), x);
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = norm(x[i]);
    if (std::abs(r - 1) > gap) worst = std::max(worst, std::abs(w[i] - (r < 1 ? 1.0 : 0.0)));
  }
  return worst;
}

void append(PointSet& cloud, const PointSet& other, float scale, const Vec3f& shift, float sign = 1) {
  for (const Vec3f& p : other.positions) cloud.positions.push_back(p * scale + shift);
  for (const Vec3f& n : other.normals) cloud.normals.push_back(n * sign);
}

TEST(WindingNumber, IsOneInsideAndZeroOutsideASphere) {
  const OrientedPatches patches = patches_of(test::sphere(40000), 0.05);
  EXPECT_NEAR(total(patches.areas), 4 * std::numbers::pi, 0.02 * 4 * std::numbers::pi);
  EXPECT_LT(sphere_error(patches, 0.1), 0.03);
}

TEST(WindingNumber, IsHalfOnTheSurface) {
  const PointSet cloud = test::sphere(40000);
  const std::vector<float> w = evaluate(WindingNumber(patches_of(cloud, 0.05)), cloud.positions);
  EXPECT_NEAR(total(w) / double(w.size()), 0.5, 0.03);
  EXPECT_GT(*std::min_element(w.begin(), w.end()), 0.2);
  EXPECT_LT(*std::max_element(w.begin(), w.end()), 0.8);
}

TEST(WindingNumber, DoesNotDependOnTheDensity) {
  // Forty times as many samples on the one side as on the other.
  const PointSet fine = test::sphere(80000);
  PointSet graded;
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t i = 0; i < fine.size(); ++i)
    if (uniform(generator) < std::pow(40.0f, -0.5f * (1 - fine.positions[i].x))) {
      graded.positions.push_back(fine.positions[i]);
      graded.normals.push_back(fine.normals[i]);
    }
  const OrientedPatches patches = patches_of(graded, 0.05);
  EXPECT_NEAR(total(patches.areas), 4 * std::numbers::pi, 0.04 * 4 * std::numbers::pi);
  EXPECT_LT(sphere_error(patches, 0.25), 0.08);
}

TEST(WindingNumber, SparseSamplesGetLargerCells) {
  // 300 samples would leave most cells of this edge empty.
  const OrientedPatches patches = patches_of(test::sphere(300), 0.03);
  EXPECT_NEAR(total(patches.areas), 4 * std::numbers::pi, 0.2 * 4 * std::numbers::pi);
  EXPECT_LT(sphere_error(patches, 0.5), 0.3);
}

TEST(WindingNumber, NoiseDoesNotCountTwice) {
  // A sheet as thick as a cell, in the worst place: along all faces of cells somewhere.
  const OrientedPatches sphere = patches_of(test::sphere(60000, 0.015), 0.06);
  EXPECT_NEAR(total(sphere.areas), 4 * std::numbers::pi, 0.06 * 4 * std::numbers::pi);
  EXPECT_LT(sphere_error(sphere, 0.15), 0.05);
  for (const float height : {0.0f, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f}) {
    PointSet plane;
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> uniform(0, 10);
    std::normal_distribution<float> gauss(0, 0.2f);
    for (int i = 0; i < 20000; ++i) {
      plane.positions.push_back(
          {uniform(generator), uniform(generator), height + std::clamp(gauss(generator), -1.f, 1.f)});
      plane.normals.push_back({0, 0, 1});
    }
    plane.positions.push_back({0, 0, -10});  // fixes the cells
    plane.normals.push_back({0, 0, 1});
    EXPECT_NEAR(total(patches_of(plane, 1).areas), 100, 9) << height;
  }
}

TEST(WindingNumber, RotationChangesLittle) {
  const PointSet cube = test::cube(60000);
  const std::vector<Vec3f> x = random_points(2000, 1.5f);
  const double angle = 0.7;
  const Vec3f axis_x(Vec3{0.8, 0.6 * std::cos(angle), 0.6 * std::sin(angle)});
  Vec3f axis_y, axis_z;
  tangent_frame(axis_x, axis_y, axis_z);
  const auto turn = [&](const Vec3f& p) { return axis_x * p.x + axis_y * p.y + axis_z * p.z; };
  PointSet turned;
  for (const Vec3f& p : cube.positions) turned.positions.push_back(turn(p));
  for (const Vec3f& n : cube.normals) turned.normals.push_back(turn(n));
  std::vector<Vec3f> y;
  for (const Vec3f& p : x) y.push_back(turn(p));
  const OrientedPatches straight = patches_of(cube, 0.06), oblique = patches_of(turned, 0.06);
  EXPECT_NEAR(total(straight.areas), 24, 0.03 * 24);
  EXPECT_NEAR(total(oblique.areas), 24, 0.03 * 24);
  const std::vector<float> a = evaluate(WindingNumber(straight), x), b = evaluate(WindingNumber(oblique), y);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float out = std::max({std::abs(x[i].x), std::abs(x[i].y), std::abs(x[i].z)}) - 1;
    if (std::abs(out) < 0.12f) continue;
    EXPECT_NEAR(a[i], out < 0 ? 1 : 0, 0.03);
    EXPECT_NEAR(b[i], a[i], 0.04);
  }
}

TEST(WindingNumber, AddsUpOverComponents) {
  // A hollow ball and another ball beside it.
  PointSet cloud = test::sphere(40000);
  append(cloud, test::sphere(20000), 0.5f, {}, -1);
  append(cloud, test::sphere(20000), 0.6f, {2.2f, 0, 0});
  const std::vector<float> w =
      evaluate(WindingNumber(patches_of(cloud, 0.06)),
               {{0, 0, 0}, {0.3f, 0, 0}, {0, 0.75f, 0}, {-0.8f, 0, 0}, {1.3f, 0, 0}, {2.2f, 0.3f, 0}, {0, 2, 0}});
  const double expected[] = {0, 0, 1, 1, 0, 1, 0};
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_NEAR(w[i], expected[i], 0.05) << i;
}

TEST(WindingNumber, SeesBothSidesOfAThinWall) {
  // A plate half a cell thick keeps its two sheets apart: no w far from it, and more between them than beside.
  PointSet plate;
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 40000; ++i) {
    const float side = i % 2 ? 1.0f : -1.0f;
    plate.positions.push_back({uniform(generator), uniform(generator), 0.03f * side});
    plate.normals.push_back({0, 0, side});
  }
  const OrientedPatches patches = patches_of(plate, 0.1);
  EXPECT_NEAR(total(patches.areas), 8, 0.3);
  const std::vector<float> w =
      evaluate(WindingNumber(patches), {{0, 0, 0}, {0.3f, 0.4f, 0}, {0, 0, 0.3f}, {0.2f, 0.1f, -0.4f}});
  EXPECT_GT(w[0], 0.5);
  EXPECT_GT(w[1], 0.5);
  EXPECT_NEAR(w[2], 0, 0.05);
  EXPECT_NEAR(w[3], 0, 0.05);
}

TEST(WindingNumber, AnOutlierWeighsLittle) {
  PointSet cloud = test::sphere(40000);
  for (const Vec3f& p : {Vec3f{1.5f, 1.5f, 1.5f}, Vec3f{-1.2f, 0, 0.1f}, Vec3f{0, 0, 4}}) {
    cloud.positions.push_back(p);
    cloud.normals.push_back({1, 0, 0});
  }
  EXPECT_NEAR(total(patches_of(cloud, 0.05).areas), 4 * std::numbers::pi, 0.03 * 4 * std::numbers::pi);
}

TEST(WindingNumber, BordersEndAtTheSamples) {
  // Half a sphere: its area, and the value half the solid angle that it fills seen from the centre.
  PointSet half;
  const PointSet whole = test::sphere(80000);
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole.positions[i].z > 0) {
      half.positions.push_back(whole.positions[i]);
      half.normals.push_back(whole.normals[i]);
    }
  const OrientedPatches patches = patches_of(half, 0.05);
  EXPECT_NEAR(total(patches.areas), 2 * std::numbers::pi, 0.03 * 2 * std::numbers::pi);
  EXPECT_NEAR(evaluate(WindingNumber(patches), {{0, 0, 0}})[0], 0.5, 0.02);
}

TEST(WindingNumber, TreeEqualsDirectSum) {
  const OrientedPatches patches = patches_of(test::torus(60000), 0.05);
  ASSERT_GT(patches.size(), 2000u);
  const WindingNumber winding(patches);
  for (const float reach : {1.4f, 5.0f, 100.0f}) {
    const std::vector<Vec3f> x = random_points(1000, reach, 13);
    const std::vector<float> w = evaluate(winding, x);
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double error = std::abs(w[i] - winding_number_direct(patches, Vec3(x[i])));
      EXPECT_LT(error, 1e-3) << reach;
      sum += error;
    }
    EXPECT_LT(sum / double(x.size()), 2e-4);
  }
}

TEST(WindingNumber, GradientMatchesDifferences) {
  const OrientedPatches patches = patches_of(test::torus(60000), 0.05);
  const WindingNumber winding(patches);
  const std::vector<Vec3f> x = random_points(500, 1.4f, 17);
  std::vector<float> w(x.size());
  std::vector<Vec3f> gradients(x.size());
  winding.evaluate(x, w, gradients);
  EXPECT_EQ(w, evaluate(winding, x));
  double scale = 0, worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vec3 difference;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 step;
      step[k] = 1e-5;
      difference[k] =
          (winding_number_direct(patches, Vec3(x[i]) + step) - winding_number_direct(patches, Vec3(x[i]) - step)) /
          2e-5;
    }
    scale = std::max(scale, norm(difference));
    worst = std::max(worst, norm(Vec3(gradients[i]) - difference));
  }
  EXPECT_GT(scale, 5);
  EXPECT_LT(worst, 0.002 * scale);
}

TEST(WindingNumber, IsTheSameForAnyThreadsAndBatches) {
  const PointSet cloud = test::torus(150000);
  const std::vector<Vec3f> x = random_points(3000, 2.0f, 19);
  const OrientedPatches patches = patches_of(cloud, 0.05);
  const std::vector<float> w = evaluate(WindingNumber(patches), x);
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    const OrientedPatches again = patches_of(cloud, 0.05);
    EXPECT_EQ(again.positions, patches.positions);
    EXPECT_EQ(again.normals, patches.normals);
    EXPECT_EQ(again.areas, patches.areas);
    EXPECT_EQ(evaluate(WindingNumber(again), x), w);
  }
  set_thread_count(0);
  const WindingNumber winding(patches);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(evaluate(winding, {x[i]})[0], w[i]);
}

TEST(WindingNumber, DoesNotDependOnTheUnit) {
  const PointSet cloud = test::sphere(20000);
  for (const float unit : {1e-12f, 1e9f}) {
    PointSet scaled;
    append(scaled, cloud, unit, {});
    const OrientedPatches patches = patches_of(scaled, 0.07 * double(unit));
    const std::vector<float> w = evaluate(
        WindingNumber(patches), {{0, 0, 0}, {0.5f * unit, 0.6f * unit, 0}, {0, 0, 1.3f * unit}, {0, 9 * unit, 0}});
    EXPECT_NEAR(w[0], 1, 0.02);
    EXPECT_NEAR(w[1], 1, 0.03);
    EXPECT_NEAR(w[2], 0, 0.02);
    EXPECT_NEAR(w[3], 0, 0.01);
  }
}

TEST(WindingNumber, BadInput) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<Vec3f> one{{1, 2, 3}}, up{{0, 0, 1}}, none;
  EXPECT_THROW(make_patches(one, none, 1), ArgumentError);
  EXPECT_THROW(make_patches(one, up, 0), ArgumentError);
  EXPECT_THROW(make_patches(one, up, nan), ArgumentError);
  EXPECT_EQ(make_patches(none, none, 1).size(), 0u);
  EXPECT_EQ(evaluate(WindingNumber(make_patches(none, none, 1)), one)[0], 0);
  EXPECT_LE(make_patches(one, up, 1).size(), 1u);
  const WindingNumber single(make_patches(one, up, 1));
  EXPECT_TRUE(std::isfinite(evaluate(single, one)[0]));
  // Samples without normal or position are left out, the cell has a lower limit, points that are nowhere have w = 0.
  PointSet cloud = test::sphere(20000);
  const OrientedPatches clean = patches_of(cloud, 0.07);
  for (const Vec3f& p : {Vec3f{nan, 0, 0}, Vec3f{0, inf, 0}, Vec3f{0, 0, 0}}) {
    cloud.positions.push_back(p);
    cloud.normals.push_back(p == Vec3f{} ? Vec3f{} : Vec3f{0, 0, 1});
  }
  EXPECT_EQ(patches_of(cloud, 0.07).areas, clean.areas);
  EXPECT_GT(patches_of(cloud, 1e-300).size(), 0u);
  const WindingNumber winding(clean);
  EXPECT_EQ(evaluate(winding, {{nan, 0, 0}, {0, inf, 0}, {0, 0, -inf}}), (std::vector<float>{0, 0, 0}));
  EXPECT_NEAR(evaluate(winding, {{0, 3e38f, 0}})[0], 0, 1e-6);
  std::vector<float> w(2);
  EXPECT_THROW(winding.evaluate(one, w), ArgumentError);
  // All samples in one place.
  const std::vector<Vec3f> same(1000, Vec3f{1, 2, 3}), ups(1000, Vec3f{0, 0, 1});
  EXPECT_LE(make_patches(same, ups, 1).size(), 1u);
}

TEST(WindingNumber, SuggestedCell) {
  const Box3 box{{0, 0, 0}, {2, 2, 2}};
  EXPECT_DOUBLE_EQ(suggest_cell(box, 0, 0.01), 0.04);
  EXPECT_DOUBLE_EQ(suggest_cell(box, 0.04, 0), 0.1);
  EXPECT_DOUBLE_EQ(suggest_cell(box, 1, 1), 0.25);
  EXPECT_GT(suggest_cell(Box3{}, 1, 1), 0);
  // A surface that fills the box well has at most some 20 000 patches.
  const PointSet sphere = test::sphere(300000);
  const OrientedPatches patches = patches_of(sphere, suggest_cell({{-1, -1, -1}, {1, 1, 1}}, 0.006, 0));
  EXPECT_GT(patches.size(), 8000u);
  EXPECT_LT(patches.size(), 22000u);
}

}  // namespace
}  // namespace sansmesh
