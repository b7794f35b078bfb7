#include "sansmesh/points/orientation/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "points/shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/sign_graph.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

void expect_recovered(PointSet points, double fraction) {
  const std::vector<Vec3f> truth = points.normals;
  scramble_signs(points, 99);
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::unoriented);
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_GE(fraction_correct(points, truth), fraction);
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::oriented);
}

TEST(SignForest, KeepsRelativeSigns) {
  std::mt19937 random(1);
  std::vector<int> sign(500);
  for (int& s : sign) s = random() & 1 ? 1 : -1;
  SignForest forest(sign.size());
  for (int i = 0; i < 20000; ++i) {
    const auto a = static_cast<std::uint32_t>(random() % sign.size());
    const auto b = static_cast<std::uint32_t>(random() % sign.size());
    forest.join(a, b, sign[a] != sign[b]);
  }
  const SignForest::Root first = forest.find(0);
  for (std::uint32_t i = 0; i < sign.size(); ++i) {
    const SignForest::Root root = forest.find(i);
    EXPECT_EQ(root.index, first.index);
    EXPECT_EQ(root.flip != first.flip, sign[i] != sign[0]);
  }
}

TEST(Contract, FollowsTheMajority) {
  // A ring of 100 nodes; each pair of neighbours has five correct votes and two wrong ones.
  std::mt19937 random(2);
  std::vector<int> sign(100);
  for (int& s : sign) s = random() & 1 ? 1 : -1;
  std::vector<SignVote> votes;
  for (std::uint32_t a = 0; a < 100; ++a)
    for (int v = 0; v < 7; ++v) {
      const std::uint32_t b = (a + 1 + random() % 3) % 100;
      votes.push_back({a, b, sign[a] * sign[b] * (v < 5 ? 10 : -5)});
    }
  SignForest forest(100);
  contract(forest, votes);
  for (std::uint32_t i = 1; i < 100; ++i) {
    EXPECT_EQ(forest.find(i).index, forest.find(0).index);
    EXPECT_EQ(forest.find(i).flip != forest.find(0).flip, sign[i] != sign[0]);
  }
}

TEST(Orientation, OfSmoothShapesIsRecovered) {
  expect_recovered(sample_sphere(5000, 1, 0, 1), 1);
  expect_recovered(sample_torus(10000, 1, 0.3f, 2), 1);
}

TEST(Orientation, CrossesSharpEdges) {
  expect_recovered(sample_box(20000, {1, 0.8f, 0.6f}, 3), 1);
  expect_recovered(sample_box(20000, {1, 1, 0.05f}, 4), 0.999);  // a plate
}

TEST(Orientation, WithEstimatedNormalsUnderNoise) {
  PointSet points = sample_sphere(20000, 1, 0.02f, 5);
  const std::vector<Vec3f> truth = points.normals;
  Progress progress;
  estimate_normals(points, {}, progress);
  orient_normals(points, {}, progress);
  EXPECT_GE(fraction_correct(points, truth), 0.995);
}

TEST(Orientation, OfEachPartIsOutward) {
  PointSet points = sample_sphere(3000, 1, 0, 6);
  append(points, sample_box(3000, {0.5f, 0.5f, 0.5f}, 7, {5, 0, 0}));
  append(points, sample_sphere(500, 0.1f, 0, 8, {0, 3, 0}));
  expect_recovered(points, 1);
}

TEST(Orientation, KeepsWhatIsRightAndTurnsWhatIsInward) {
  PointSet points = sample_torus(8000, 1, 0.3f, 9);
  const std::vector<Vec3f> truth = points.normals;
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::oriented);
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_EQ(points.normals, truth);
  for (Vec3f& n : points.normals) n = -n;
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::inward);
  orient_normals(points, {}, progress);
  EXPECT_EQ(points.normals, truth);
}

TEST(Orientation, NormalsAlongPositiveAxesAreNotOriented) {
  PointSet points = sample_box(20000, {1, 0.8f, 0.6f}, 10);
  for (Vec3f& n : points.normals) n = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::unoriented);
}

TEST(Orientation, SingleWrongSignsAreForgiven) {
  PointSet points = sample_torus(8000, 1, 0.3f, 11);
  for (std::size_t i = 0; i < points.size(); i += 50) points.normals[i] = -points.normals[i];
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::oriented);
}

TEST(Orientation, IsNotThereWhereNormalsAreAtRandom) {
  PointSet points = sample_torus(8000, 1, 0.3f, 21);
  std::mt19937 random(22);
  for (Vec3f& n : points.normals) n = random_direction(random);
  OrientationReport report = measure_orientation(points);
  EXPECT_EQ(report.check, OrientationCheck::unoriented);
  EXPECT_LT(report.related, 0.1);
  EXPECT_NEAR(report.agreement, 0.5, 0.05);
  // No choice of signs makes them consistent.
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::unoriented);
}

TEST(Orientation, SaysWhereNormalsLook) {
  PointSet points = sample_sphere(6000, 1, 0, 23);
  append(points, sample_sphere(2000, 1, 0, 24, {4, 0, 0}));
  for (std::size_t i = 6000; i < 8000; ++i) points.normals[i] = -points.normals[i];
  OrientationReport report = measure_orientation(points);
  EXPECT_EQ(report.check, OrientationCheck::oriented);
  EXPECT_NEAR(report.inward, 0.25, 0.01);
  EXPECT_NEAR(report.outward, 0.75, 0.01);
  PointSet sheet;
  for (std::size_t i = 0; i < 6000; ++i)
    if (points.positions[i].z > 0) {
      sheet.positions.push_back(points.positions[i]);
      sheet.normals.push_back(points.normals[i]);
    }
  report = measure_orientation(sheet);
  EXPECT_EQ(report.check, OrientationCheck::oriented);
  EXPECT_EQ(report.open, 1) << "half a ball has no outside";
}

/// A ball with two rods whose thickness equals the noise in the worst case.
PointSet ball_with_rods(std::size_t n, float noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> g;
  std::uniform_real_distribution<float> u(0, 1);
  PointSet points;
  while (points.size() < n) {
    Vec3f p, normal;
    if (u(random) < 0.6f) {
      normal = random_direction(random);
      p = normal * 0.5f;
      if (std::hypot(p.y, p.z) < 0.1f) continue;  // inside the rods
    } else {
      const float a = 6.2831853f * u(random);
      normal = {0, std::cos(a), std::sin(a)};
      p = normal * 0.1f;
      p.x = (0.49f + 0.8f * u(random)) * (u(random) < 0.5f ? -1.0f : 1.0f);
    }
    points.positions.push_back(p + Vec3f{g(random), g(random), g(random)} * noise);
    points.normals.push_back(normal);
  }
  return points;
}

TEST(Orientation, IsCertainOnlyWhereItIsRight) {
  std::size_t certain = 0;
  for (const float noise : {0.0f, 0.02f, 0.045f, 0.08f})
    for (const bool rods : {false, true}) {
      PointSet points = rods ? ball_with_rods(8000, noise, 31) : sample_torus(8000, 1, 0.3f, 32);
      std::mt19937 random(33);
      std::normal_distribution<float> g(0, noise > 0 ? noise : 1);
      if (!rods && noise > 0)
        for (Vec3f& p : points.positions) p += Vec3f{g(random), g(random), g(random)};
      const std::vector<Vec3f> truth = points.normals;
      Progress progress;
      estimate_normals(points, {}, progress);
      orient_normals(points, {}, progress);
      const double correct = fraction_correct(points, truth);
      const OrientationReport report = measure_orientation(points);
      EXPECT_TRUE(correct > 0.95 || !report.certain()) << noise << (rods ? " rods" : " torus");
      EXPECT_TRUE(noise > 0.015f || report.certain()) << noise << (rods ? " rods" : " torus");
      certain += report.certain();
    }
  EXPECT_LT(certain, 8u) << "rods that are thinner than the noise have no sides";
}

TEST(Orientation, RegionsThatAreTurnedRaiseDoubt) {
  // Along a clean cut hardly any neighbours contradict each other.
  PointSet points = sample_sphere(20000, 1, 0, 34);
  EXPECT_TRUE(measure_orientation(points).certain());
  EXPECT_LT(measure_orientation(points).doubt, 0.01);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points.positions[i].z > 0.2f) points.normals[i] = -points.normals[i];
  const OrientationReport report = measure_orientation(points);
  EXPECT_GT(report.agreement, 0.9);
  EXPECT_GT(report.doubt, 0.3);
  EXPECT_FALSE(report.certain());
}

TEST(Orientation, ThinPlatesAreOriented) {
  EXPECT_EQ(measure_orientation(sample_box(8000, {1, 1, 0.01f}, 12), {}, false).check, OrientationCheck::oriented);
}

PointSet with_noise(PointSet points, float noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> g(0, noise);
  for (Vec3f& p : points.positions) p += Vec3f{g(random), g(random), g(random)};
  return points;
}

/// Share of right signs of normals estimated without knowledge of the true ones.
double share_recovered(const PointSet& samples, OrientBy by = OrientBy::automatic) {
  PointSet points = samples;
  Progress progress;
  estimate_normals(points, {}, progress);
  orient_normals(points, {.by = by}, progress);
  return fraction_correct(points, samples.normals);
}

TEST(Orientation, WindingNumbersDecideWhereNoiseIsAsThickAsTheShape) {
  // Votes of neighbours alone give 67 to 84 % right signs, depending on the rotation.
  const PointSet ring = with_noise(sample_torus(4000, 1, 0.1f, 5), 0.03f, 6);
  EXPECT_GT(share_recovered(ring), 0.975);
  PointSet turned = ring;
  for (auto* vectors : {&turned.positions, &turned.normals})
    for (Vec3f& v : *vectors) v = {0.6f * v.x - 0.8f * v.z, v.y, 0.8f * v.x + 0.6f * v.z};
  EXPECT_GT(share_recovered(turned), 0.975);
  PointSet with_stray = ring;
  append(with_stray, sample_sphere(1, 0, 0, 1, {30, 20, 10}));
  EXPECT_GT(share_recovered(with_stray), 0.975);
  EXPECT_GT(share_recovered(ball_with_rods(1500, 0.045f, 31)), 0.97);
}

TEST(Orientation, BothOfTwoTouchingBallsFaceOutward) {
  PointSet points = sample_sphere(6000, 1, 0.05f, 1);
  append(points, sample_sphere(6000, 1, 0.05f, 2, {1.95f, 0, 0}));
  EXPECT_GT(share_recovered(points), 0.97);
}

TEST(Orientation, TheSidesOfNoisyPlatesOfTwoSpacingsFaceOutward) {
  const std::size_t n = 5000;
  const float spacing = std::sqrt(8.0f / n);
  for (const float noise : {0.0f, 0.1f, 0.2f, 0.3f})
    EXPECT_GT(share_recovered(with_noise(sample_box(n, {1, 1, spacing}, 7), noise * spacing, 8)), 0.95) << noise;
}

TEST(Orientation, SingleSheetsAreNotFolded) {
  // Their winding numbers would be more even with a cut at each slope.
  for (const float height : {0.1f, 0.4f}) {
    PointSet points;
    std::mt19937 random(15);
    std::uniform_real_distribution<float> u(0, 1);
    for (int i = 0; i < 4000; ++i) {
      const float x = u(random), y = u(random);
      points.positions.push_back({x, y, height * std::sin(6.28f * x)});
      points.normals.push_back(normalized(Vec3f{-6.28f * height * std::cos(6.28f * x), 0, 1}));
    }
    const double right = share_recovered(with_noise(points, 0.005f, 16), OrientBy::propagation);
    EXPECT_GT(std::max(right, 1 - right), 0.99) << height;
  }
  PointSet half;
  const PointSet ring = sample_torus(8000, 1, 0.3f, 17);
  for (std::size_t i = 0; i < ring.size(); ++i)
    if (ring.normals[i].z > 0.2f) half.positions.push_back(ring.positions[i]), half.normals.push_back(ring.normals[i]);
  const double right = share_recovered(with_noise(half, 0.01f, 18), OrientBy::propagation);
  EXPECT_GT(std::max(right, 1 - right), 0.99);
}

TEST(Orientation, ScannersDecide) {
  // The inside of a sphere seen from its centre: the correct normals point inward.
  PointSet points = sample_sphere(4000, 1, 0, 13, {2, 0, 0});
  points.scanners = {{2, 0, 0}};
  points.scan_of_point.assign(points.size(), 0);
  std::vector<Vec3f> truth = points.normals;
  for (Vec3f& n : truth) n = -n;
  scramble_signs(points, 14);
  PointSet blind = points;
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_EQ(points.normals, truth);
  orient_normals(blind, {.by = OrientBy::propagation}, progress);
  EXPECT_EQ(fraction_correct(blind, truth), 0);
}

TEST(Orientation, ScannersThatSawNothingDecideNothing) {
  PointSet points = sample_sphere(4000, 1, 0, 13, {2, 0, 0});
  const std::vector<Vec3f> truth = points.normals;
  points.scanners = {{2, 0, 0}};
  points.scan_of_point.assign(points.size(), 9);  // nonexistent scanner
  scramble_signs(points, 14);
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_EQ(points.normals, truth);
}

TEST(Orientation, ATerrainLooksUp) {
  PointSet points;
  std::mt19937 random(15);
  std::uniform_real_distribution<float> u(0, 10);
  for (int i = 0; i < 5000; ++i) {
    const float x = u(random), y = u(random);
    points.positions.push_back({x, y, 0.3f * std::sin(x) * std::sin(y)});
    points.normals.push_back(
        normalized(Vec3f{-0.3f * std::cos(x) * std::sin(y), -0.3f * std::sin(x) * std::cos(y), 1}));
  }
  const std::vector<Vec3f> truth = points.normals;
  scramble_signs(points, 16);
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_EQ(fraction_correct(points, truth), 1);
}

/// A floor with 25 samples in a square of edge 1. `keep`: whether it exists there.
template <class Keep>
PointSet wavy_floor(float height, unsigned seed, const Keep& keep) {
  PointSet points;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-15, 15);
  for (int i = 0; i < 22500; ++i) {
    const Vec3f p{u(random), u(random), 0};
    if (!keep(p)) continue;
    points.positions.push_back(p + Vec3f{0, 0, height * std::sin(0.4f * p.x) * std::cos(0.3f * p.y)});
    points.normals.push_back(normalized(Vec3f{-0.4f * height * std::cos(0.4f * p.x) * std::cos(0.3f * p.y),
                                              0.3f * height * std::sin(0.4f * p.x) * std::sin(0.3f * p.y), 1}));
  }
  return points;
}
PointSet wavy_floor(float height, unsigned seed) {
  return wavy_floor(height, seed, [](const Vec3f&) { return true; });
}

/// Expects the floor to face up and the objects outward.
void expect_scene(const PointSet& samples, double right) {
  for (const float noise : {0.0f, 0.04f}) {
    PointSet points = with_noise(samples, noise, 21);
    Progress progress;
    estimate_normals(points, {}, progress);
    EXPECT_EQ(orient_normals(points, {}, progress), OrientBy::up);
    EXPECT_GT(fraction_correct(points, samples.normals), right) << noise;
  }
}

TEST(Orientation, ObjectsAboveAFloorFaceOutward) {
  PointSet points = wavy_floor(0.7f, 22);
  append(points, sample_sphere(3800, 3.5f, 0, 23, {-5, -3, 6.5f}));
  append(points, sample_box(4000, {3, 2.5f, 2}, 24, {7, 5, 6}));
  expect_scene(points, 0.999);
}

TEST(Orientation, ObjectsThatTouchAFloorFaceOutward) {
  PointSet points = wavy_floor(0, 25);
  append(points, sample_sphere(3800, 3.5f, 0, 26, {-5, -3, 3.5f}));
  expect_scene(points, 0.99);
  // Sunk: floor and ball are one sheet with an overhang.
  const Vec3f center{-5, -3, 2.5f};
  points = wavy_floor(0, 27, [&](const Vec3f& p) { return norm(p - center) > 3.5f; });
  const PointSet ball = sample_sphere(3800, 3.5f, 0, 28, center);
  for (std::size_t i = 0; i < ball.size(); ++i)
    if (ball.positions[i].z > 0)
      points.positions.push_back(ball.positions[i]), points.normals.push_back(ball.normals[i]);
  expect_scene(points, 0.99);
}

TEST(Orientation, TheUndersideOfATableFacesDown) {
  const auto in_leg = [](const Vec3f& p) { return std::hypot(p.x - 2, p.y) < 0.7f; };
  PointSet points = wavy_floor(0, 29, [&](const Vec3f& p) { return !in_leg(p); });
  PointSet table = sample_box(5000, {5, 4, 0.5f}, 30, {2, 0, 5});
  for (std::size_t i = 0; i < table.size(); ++i)
    if (!in_leg(table.positions[i]) || table.positions[i].z > 5)
      points.positions.push_back(table.positions[i]), points.normals.push_back(table.normals[i]);
  std::mt19937 random(31);
  std::uniform_real_distribution<float> u(0, 1);
  for (int i = 0; i < 500; ++i) {
    const float angle = 6.2831853f * u(random);
    const Vec3f n{std::cos(angle), std::sin(angle), 0};
    points.positions.push_back(Vec3f{2, 0, 4.5f * u(random)} + n * 0.7f), points.normals.push_back(n);
  }
  expect_scene(points, 0.99);
}

TEST(Orientation, NormalsThatAreNotFiniteHaveNoEffect) {
  const PointSet ring = with_noise(sample_torus(4000, 1, 0.1f, 5), 0.03f, 6);
  PointSet points = ring;
  Progress progress;
  estimate_normals(points, {}, progress);
  // Neighbours alone decide wrongly; the winding number is a sum over many samples.
  for (std::size_t i = 0; i < 20; ++i)
    points.normals[i].y = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : INFINITY;
  orient_normals(points, {}, progress);
  EXPECT_GT(fraction_correct(points, ring.normals), 0.97);
}

TEST(Orientation, ZeroNormalsStayZero) {
  PointSet points = sample_sphere(3000, 1, 0, 13);
  points.normals.assign(points.size(), {});
  Progress progress;
  orient_normals(points, {}, progress);
  EXPECT_EQ(points.normals, std::vector<Vec3f>(points.size()));
}

TEST(Orientation, DoesNotDependOnTheNumberOfThreads) {
  Progress progress;
  // Neighbours decide the signs of the first, winding numbers those of the second.
  for (PointSet points : {sample_sphere(20000, 1, 0.04f, 17), with_noise(sample_torus(4000, 1, 0.1f, 5), 0.03f, 6)}) {
    estimate_normals(points, {}, progress);
    test::expect_equal_for_any_threads([&] {
      PointSet oriented = points;
      orient_normals(oriented, {}, progress);
      return oriented.normals;
    });
  }
}

TEST(Orientation, MissingNormals) {
  PointSet points = sample_sphere(500, 1, 0, 18);
  Progress progress;
  EXPECT_THROW(orient_normals(points, {.neighbours = 1}, progress), ArgumentError);
  points.normals.assign(points.size(), {});
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::missing);
  orient_normals(points, {}, progress);
  for (const Vec3f& n : points.normals) EXPECT_EQ(norm(n), 0);
  points.normals.clear();
  EXPECT_EQ(measure_orientation(points, {}, false).check, OrientationCheck::missing);
  EXPECT_EQ(measure_orientation({}, {}, false).check, OrientationCheck::missing);
  EXPECT_THROW(orient_normals(points, {}, progress), DataError);
}

}  // namespace
}  // namespace sansmesh::inline v1
