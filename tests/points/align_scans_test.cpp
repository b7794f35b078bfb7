// Detection, report and correction of misaligned scans.
#include "sansmesh/points/registration/align_scans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/points/prepare_cloud.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

/// A bumpy ball whose shape determines all six motions.
Vec3 bumpy(const Vec3& direction) {
  const Vec3& d = direction;
  return d * (1 + 0.15 * std::sin(4 * d.x + 1) + 0.12 * std::cos(5 * d.y) + 0.1 * std::sin(3 * d.z + 2 * d.x));
}

Vec3 bumpy_normal(const Vec3& d) {
  Vec3 t, b;
  tangent_frame(d, t, b);
  constexpr double h = 1e-5;
  const auto along = [&](const Vec3& v) { return bumpy(normalized(d + v * h)) - bumpy(normalized(d - v * h)); };
  return normalized(cross(along(t), along(b)));
}

constexpr double kSpacing = 0.025;

/// Views of `scans` scanners around it, at most a quarter turn apart.
PointSet seen_from(std::size_t scans, double noise, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  PointSet cloud;
  for (std::size_t s = 0; s < scans; ++s) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(s) / std::max(4.0, static_cast<double>(scans));
    const Vec3 eye = normalized(Vec3{std::cos(angle), std::sin(angle), s % 2 ? 0.4 : -0.4});
    cloud.scanners.push_back(Vec3f(eye * 10.0));
    cloud.scan_names.push_back("scan" + std::to_string(s) + ".ply");
    for (std::size_t k = 0; k < 14000; ++k) {
      const Vec3 d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
      const Vec3 n = bumpy_normal(d);
      if (dot(d, eye) < 0 || dot(n, eye * 10.0 - bumpy(d)) < 0.5) continue;
      cloud.positions.push_back(Vec3f(bumpy(d) + n * (noise * gauss(random))));
      cloud.normals.push_back(Vec3f(n));
      cloud.scan_of_point.push_back(static_cast<std::uint16_t>(s));
    }
  }
  return cloud;
}

/// Rotation by half a degree about an axis through the centre, and a shift by two spacings.
Similarity half_a_degree(const Vec3& axis, const Vec3& direction) {
  Similarity motion = rotation_by(normalized(axis) * (0.5 * std::numbers::pi / 180));
  motion.translation = normalized(direction) * (2 * kSpacing);
  return motion;
}

/// Root mean square error of sample positions relative to scan 0.
double farthest_off(const PointSet& truth, const PointSet& moved) {
  std::size_t far = 0, side = 0;  // three samples of scan 0 that span a frame, with sample 0
  const auto from_first = [&](const PointSet& p, std::size_t i) { return Vec3(p.positions[i]) - Vec3(p.positions[0]); };
  while (norm(from_first(truth, far)) < 1) ++far;
  while (norm(cross(normalized(from_first(truth, far)), from_first(truth, side))) < 0.7) ++side;
  const auto frame = [&](const PointSet& p) {
    Similarity f;
    auto& [x, y, z] = f.columns;
    x = normalized(from_first(p, far));
    z = normalized(cross(x, from_first(p, side)));
    y = cross(z, x);
    f.translation = Vec3(p.positions[0]);
    return f;
  };
  const Similarity f = frame(truth), g = frame(moved);
  double squares = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    squares += squared_norm(f.back(Vec3(truth.positions[i])) - g.back(Vec3(moved.positions[i])));
  return std::sqrt(squares / static_cast<double>(truth.size()));
}

Similarity no_motion() { return {}; }

TEST(AlignScans, FindsKnownMotionsBack) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others align scans, too");
  Progress progress;
  for (const std::size_t scans : {std::size_t{2}, std::size_t{5}})
    for (const double noise : {0.0, 0.2 * kSpacing}) {
      SCOPED_TRACE(testing::Message() << scans << " scans, noise " << noise);
      const PointSet truth = seen_from(scans, noise);
      PointSet cloud = truth;
      std::vector<Similarity> known(scans, no_motion());
      for (std::size_t s = 1; s < scans; ++s)
        known[s] = half_a_degree(Vec3{1.0 * (s % 3), 1, 0.3}, Vec3{1, -0.5 * static_cast<double>(s), 0.7});
      move_scans(cloud, known);
      const double before = farthest_off(truth, cloud);
      EXPECT_GT(before, kSpacing);
      const ScanAlignment found = find_scan_motions(cloud, {}, progress);
      EXPECT_TRUE(found.disagree());
      move_scans(cloud, found.motions);
      EXPECT_LT(farthest_off(truth, cloud), 0.1 * kSpacing);
      EXPECT_NEAR(found.noise, noise, 0.3 * noise + 0.02 * kSpacing);
      EXPECT_FALSE(find_scan_motions(cloud, {}, progress).disagree());
    }
}

TEST(AlignScans, LeavesTheMeanWhereItIs) {
  Progress progress;
  PointSet cloud = seen_from(3, 0);
  move_scans(cloud, {no_motion(), half_a_degree({0, 0, 1}, {1, 1, 0}), no_motion()});
  const ScanAlignment found = find_scan_motions(cloud, {.samples = 100000}, progress);
  const PointSet given = cloud;
  move_scans(cloud, found.motions);
  Vec3 sum;
  double most = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 d = Vec3(cloud.positions[i]) - Vec3(given.positions[i]);
    sum += d, most = std::max(most, norm(d));
  }
  EXPECT_GT(most, kSpacing);
  EXPECT_LT(norm(sum) / static_cast<double>(cloud.size()), 0.02 * kSpacing);
}

TEST(AlignScans, ScansThatFitAreLeftAlone) {
  SANSMESH_NOT_SANITIZED("judges a choice; others align scans, too");
  Progress progress;
  for (const double noise : {0.0, 0.1 * kSpacing, 0.5 * kSpacing}) {
    SCOPED_TRACE(testing::Message() << "noise " << noise);
    const PointSet cloud = seen_from(4, noise);
    const ScanAlignment found = find_scan_motions(cloud, {}, progress);
    EXPECT_FALSE(found.disagree());
    for (const double d : found.displacements) EXPECT_LT(d, std::max(0.1 * noise, 0.01 * kSpacing));
    EXPECT_TRUE(prepare_cloud(cloud, {}, progress).notes.empty());
  }
}

/// A scan warped by more than its noise cannot be aligned with the others and stays unchanged.
TEST(AlignScans, TellsWarpedScansFromMisalignedOnes) {
  SANSMESH_NOT_SANITIZED("judges a choice; others align scans, too");
  Progress progress;
  PointSet cloud = seen_from(4, 0.1 * kSpacing);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.scan_of_point[i] == 2) {
      const Vec3f p = cloud.positions[i];
      const auto bend = static_cast<float>(0.6 * kSpacing * std::sin(14 * p.x) * std::sin(14 * p.y + 3 * p.z));
      cloud.positions[i] += cloud.normals[i] * bend;
    }
  const ScanAlignment found = find_scan_motions(cloud, {}, progress);
  EXPECT_TRUE(found.warped());
  EXPECT_FALSE(found.disagree());
  EXPECT_EQ(found.farthest_off(), 2u);
  const PreparedCloud plain = prepare_cloud(cloud, {}, progress),
                      aligned = prepare_cloud(cloud, {.align = true}, progress);
  EXPECT_EQ(plain.points.positions, aligned.points.positions);
  ASSERT_EQ(plain.notes.size(), 1u);
  EXPECT_NE(plain.notes[0].text.find("warped"), std::string::npos);
}

/// Both sides of a plate, three spacings thick, each seen by one scanner, have no surface in common.
TEST(AlignScans, DoesNotPullTheSidesOfAPlateTogether) {
  Progress progress;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PointSet cloud;
  cloud.scanners = {{0, 0, 9}, {0, 0, -9}};
  for (std::size_t i = 0; i < 12000; ++i) {
    const double x = uniform(random), y = uniform(random), side = i % 2 ? -1 : 1;
    cloud.positions.push_back(Vec3f(Vec3{x, y, 0.1 * std::sin(3 * x) * std::cos(2 * y) + side * 0.0375}));
    cloud.normals.push_back(
        Vec3f(normalized(Vec3{-0.3 * std::cos(3 * x) * std::cos(2 * y), 0.2 * std::sin(3 * x) * std::sin(2 * y), 1.0}) *
              side));
    cloud.scan_of_point.push_back(static_cast<std::uint16_t>(i % 2));
  }
  const ScanAlignment found = find_scan_motions(cloud, {}, progress);
  EXPECT_FALSE(found.disagree());
  EXPECT_EQ(found.rounds, 0);
}

TEST(AlignScans, OneScanAloneIsUnchanged) {
  Progress progress;
  PointSet cloud = seen_from(1, 0);
  const ScanAlignment found = find_scan_motions(cloud, {}, progress);
  EXPECT_TRUE(found.motions.empty());
  EXPECT_FALSE(found.disagree());
  const PreparedCloud plain = prepare_cloud(cloud, {}, progress),
                      aligned = prepare_cloud(cloud, {.align = true}, progress);
  EXPECT_EQ(plain.points.positions, aligned.points.positions);
  EXPECT_TRUE(plain.notes.empty());
  EXPECT_EQ(aligned.notes.size(), 1u);
  cloud.scan_of_point.clear(), cloud.scanners.clear();
  EXPECT_EQ(prepare_cloud(cloud, {}, progress).points.positions, plain.points.positions);
}

TEST(AlignScans, IsToldAndDoneByThePreparation) {
  Progress progress;
  PointSet cloud = seen_from(3, 0.1 * kSpacing);
  move_scans(cloud, {no_motion(), half_a_degree({0, 0, 1}, {1, 1, 0}), no_motion()});
  const PreparedCloud plain = prepare_cloud(cloud, {}, progress);
  ASSERT_EQ(plain.notes.size(), 1u) << plain.notes[0].text;
  EXPECT_TRUE(plain.notes[0].text.ends_with("scan1.ply")) << plain.notes[0].text;
  EXPECT_TRUE(plain.notes[0].remedy.starts_with("`align`")) << plain.notes[0].remedy;
  for (const NormalUse normals : {NormalUse::automatic, NormalUse::estimate}) {
    const PreparedCloud aligned = prepare_cloud(cloud, {.normals = normals, .align = true}, progress);
    EXPECT_TRUE(aligned.notes.empty());
    EXPECT_FALSE(aligned.alignment.empty());
    EXPECT_FALSE(find_scan_motions(aligned.points, {}, progress).disagree());
  }
}

TEST(AlignScans, MovesAllThatHasADirection) {
  PointSet cloud = seen_from(2, 0);
  cloud.grid_normals = cloud.normals;
  const PointSet given = cloud;
  const Similarity motion = half_a_degree({1, 2, 3}, {0, 1, 0});
  move_scans(cloud, {motion, no_motion()});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Similarity m = cloud.scan_of_point[i] == 0 ? motion : no_motion();
    ASSERT_LT(norm(Vec3(cloud.positions[i]) - m(Vec3(given.positions[i]))), 1e-6);
    ASSERT_LT(norm(Vec3(cloud.normals[i]) - m.rotate(Vec3(given.normals[i]))), 1e-6);
    ASSERT_EQ(cloud.grid_normals[i], cloud.normals[i]);
    ASSERT_LT(norm(m.back(m(Vec3(given.positions[i]))) - Vec3(given.positions[i])), 1e-12);
  }
  EXPECT_LT(norm(Vec3(cloud.scanners[0]) - motion(Vec3(given.scanners[0]))), 1e-5);
  EXPECT_EQ(cloud.scanners[1], given.scanners[1]);
  EXPECT_THROW(move_scans(cloud, {motion}), ArgumentError);
}

TEST(AlignScans, SameForAnyNumberOfThreads) {
  PointSet cloud = seen_from(3, 0.1 * kSpacing);
  move_scans(cloud, {no_motion(), half_a_degree({0, 0, 1}, {1, 1, 0}), no_motion()});
  test::expect_equal_for_any_threads([&] {
    Progress progress;
    PointSet moved = cloud;
    move_scans(moved, find_scan_motions(cloud, {.samples = 500}, progress).motions);
    return moved.positions;
  });
}

TEST(AlignScans, WantsNormalsAndSoundOptions) {
  Progress progress;
  PointSet cloud = seen_from(2, 0);
  EXPECT_THROW(find_scan_motions(cloud, {.samples = 3}, progress), ArgumentError);
  EXPECT_THROW(find_scan_motions(cloud, {.rounds = 0}, progress), ArgumentError);
  cloud.normals.clear();
  EXPECT_THROW(find_scan_motions(cloud, {}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
