#include "sansmesh/points/normals/denoise_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "points/shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/statistics/spacing.h"
#include "support/any_threads.h"
#include "support/edged_shapes.h"
#include "support/places.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

double angle(const Vec3f& a, const Vec3f& b) {
  return std::acos(std::min(1.0, std::abs(dot(Vec3(a), Vec3(b))))) * 180 / 3.14159265358979;
}

void add_noise(PointSet& points, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> g;
  for (Vec3f& p : points.positions) p = Vec3f(Vec3(p) + Vec3{g(random), g(random), g(random)} * deviation);
}

/// Share of samples whose normal deviates from the true one by more than `degrees`.
double share_off(const PointSet& points, const std::vector<Vec3f>& truth, double degrees) {
  std::size_t off = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) off += angle(points.normals[i], truth[i]) > degrees;
  return static_cast<double>(off) / static_cast<double>(truth.size());
}

double mean_square(const PointSet& points, const std::vector<Vec3f>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(angle(points.normals[i], truth[i]), 2);
  return sum / static_cast<double>(truth.size());
}

void estimate(PointSet& points) {
  Progress progress;
  estimate_normals(points, {}, progress);
}

void denoise(PointSet& points, const NormalDenoisingOptions& options = {}) {
  Progress progress;
  denoise_normals(points, options, progress);
}

TEST(DenoiseNormals, GivesSamplesNearEdgesTheNormalOfTheirFace) {
  for (const double noise : {0.0, 0.05, 0.2}) {
    PointSet box = sample_box(15000, {1, 0.8f, 0.6f}, 1);
    const std::vector<Vec3f> truth = box.normals;
    add_noise(box, noise * estimate_spacing(box), 2);
    estimate(box);
    const double before = share_off(box, truth, 10);
    EXPECT_GT(before, 0.05);
    denoise(box);
    EXPECT_LT(share_off(box, truth, 10), noise < 0.1 ? 0.015 : 0.4 * before);
    // Nearly every normal is that of some face; at an edge either face is accepted.
    std::size_t blurred = 0;
    for (const Vec3f& n : box.normals) blurred += std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) < 0.985f;
    EXPECT_LT(blurred, noise < 0.1 ? box.size() / 200 : box.size() / 25);
  }
}

/// Three quarters of the wrong normals are corrected.
void expect_sharper(PointSet model) {
  const std::vector<Vec3f> truth = model.normals;
  add_noise(model, 0.05 * estimate_spacing(model), 3);
  estimate(model);
  const double before = share_off(model, truth, 10);
  EXPECT_GT(before, 0.03);
  denoise(model);
  EXPECT_LT(share_off(model, truth, 10), 0.25 * before);
}

PointSet samples_of(const TriangleMesh& mesh, std::size_t n) {
  PointSet faces;
  faces.positions = mesh.vertices, faces.triangles = mesh.triangles;
  return sample_faces(faces, n);
}

TEST(DenoiseNormals, SharpensEdgesOfManyAngles) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others denoise, too");
  expect_sharper(samples_of(test::icosahedron(), 20000));
  expect_sharper(samples_of(test::swept_profile(), 20000));
}

TEST(ExtraDenoiseNormals, SharpensTheFanDisk) {
  const std::string file = test::shared_points("fandisk.off");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no " << file;
  expect_sharper(sample_faces(read_points(file), 20000));
}

TEST(DenoiseNormals, LeavesSmoothShapesAsTheyAre) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others denoise, too");
  for (const bool torus : {false, true}) {
    PointSet points = torus ? sample_torus(15000, 1, 0.4f, 4) : sample_sphere(15000, 1, 0, 4);
    const std::vector<Vec3f> truth = points.normals;
    denoise(points);
    EXPECT_LT(std::sqrt(mean_square(points, truth)), 0.6);
    for (const double noise : {0.05, 0.2, 0.5}) {
      PointSet noisy = points;
      add_noise(noisy, noise * estimate_spacing(points), 5);
      estimate(noisy);
      const double before = mean_square(noisy, truth);
      denoise(noisy);
      EXPECT_LT(mean_square(noisy, truth), 0.7 * before) << torus << noise;
    }
  }
}

TEST(DenoiseNormals, KeepsSignsWhateverTheyAre) {
  PointSet box = sample_box(8000, {1, 1, 1}, 6);
  add_noise(box, 0.001, 7);
  estimate(box);
  PointSet scrambled = box;
  scramble_signs(scrambled, 8);
  const std::vector<Vec3f> before = scrambled.normals;
  denoise(box);
  denoise(scrambled);
  for (std::size_t i = 0; i < box.size(); ++i) {
    EXPECT_GT(dot(before[i], scrambled.normals[i]), -1e-3f);
    EXPECT_NEAR(norm(scrambled.normals[i]), 1, 1e-5);
    ASSERT_LT(angle(box.normals[i], scrambled.normals[i]), 1);
  }
}

TEST(DenoiseNormals, IsTheSameForAnyNumberOfThreads) {
  PointSet points = sample_box(6000, {1, 0.5f, 0.5f}, 9);
  add_noise(points, 0.004, 10);
  estimate(points);
  test::expect_equal_for_any_threads([&] {
    PointSet denoised = points;
    denoise(denoised);
    return denoised.normals;
  });
}

TEST(DenoiseNormals, SurvivesDegenerateInput) {
  PointSet points;
  denoise(points);
  points.positions.assign(50, {1, 2, 3});
  points.normals.assign(50, {0, 0, 1});
  denoise(points);
  for (const Vec3f& n : points.normals) EXPECT_EQ(n, (Vec3f{0, 0, 1}));
  points = sample_sphere(1000, 1, 0, 11);
  points.positions[3].x = std::numeric_limits<float>::quiet_NaN();
  points.normals[4] = {};
  points.normals[5].x = std::numeric_limits<float>::infinity();
  denoise(points);
  EXPECT_EQ(points.normals[4], (Vec3f{}));
  EXPECT_EQ(points.normals[5], (Vec3f{}));
  EXPECT_NEAR(norm(points.normals[6]), 1, 1e-5);
  points.normals.clear();
  EXPECT_THROW(denoise(points), DataError);
  const auto bad = [&](auto change) {
    NormalDenoisingOptions options;
    change(options);
    EXPECT_THROW(denoise(points, options), ArgumentError);
  };
  bad([](NormalDenoisingOptions& o) { o.neighbours = 2; });
  bad([](NormalDenoisingOptions& o) { o.rounds = -1; });
  bad([](NormalDenoisingOptions& o) { o.angle = 0; });
  bad([](NormalDenoisingOptions& o) { o.spacing = -1; });
  bad([](NormalDenoisingOptions& o) { o.noise = -1; });
}

}  // namespace
}  // namespace sansmesh::inline v1
