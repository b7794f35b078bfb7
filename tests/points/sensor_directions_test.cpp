// Directions to the sensor (flight lines, height fields, scanners, depth frames) and orientation of normals by them.
#include "sansmesh/points/normals/sensor_directions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "points/shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/points/normals/flight_lines.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/points/shape/height_field.h"
#include "support/any_threads.h"
#include "support/places.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Vec3 hill_normal(const Vec3& p) {
  return normalized(
      Vec3{-0.3 * std::cos(0.03 * p.x) * std::cos(0.04 * p.y), 0.4 * std::sin(0.03 * p.x) * std::sin(0.04 * p.y), 1});
}
double hill_height(double x, double y) { return 10 * std::sin(0.03 * x) * std::cos(0.04 * y); }

/// Hills seen from an aircraft 900 above them, in two lines of opposite directions; its mirror swings by 20° to both
/// sides. `towards`: the true directions to it.
struct Survey {
  PointSet points;
  std::vector<Vec3f> towards;
  std::vector<float> angle;
  std::vector<double> time;
  std::vector<std::uint16_t> line;
};

Survey fly(std::size_t n, double heading, std::optional<double> second_heading = {}) {
  Survey s;
  for (std::size_t i = 0; i < n; ++i) {
    const bool second = 2 * i >= n;
    const double t = static_cast<double>(second ? 2 * i - n : 2 * i) / static_cast<double>(n) * 12;
    const double h = (second ? second_heading.value_or(heading + 180) : heading) * kDegree;
    const Vec3 along{std::cos(h), std::sin(h), 0}, right{std::sin(h), -std::cos(h), 0};
    const Vec3 eye = along * (60 * (t - 6)) + right * 80.0 + Vec3{0, 0, 900};
    const double angle = 20 * std::sin(40 * t) * kDegree;
    Vec3 p = eye + right * (900 * std::tan(angle));
    p.z = hill_height(p.x, p.y);
    s.points.positions.emplace_back(p);
    s.points.normals.emplace_back(hill_normal(p));
    s.towards.emplace_back(normalized(eye - p));
    s.angle.push_back(static_cast<float>(std::round(angle / kDegree)));
    s.time.push_back(240000 + (second ? 500 : 0) + t);
    s.line.push_back(second ? 12 : 11);
  }
  return s;
}

double least_cosine(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  double least = 1;
  for (std::size_t i = 0; i < a.size(); ++i) least = std::min(least, static_cast<double>(dot(a[i], b[i])));
  return least;
}

TEST(FlightLines, ShowWhereTheSensorWas) {
  for (const double heading : {0.0, 37.0, 200.0}) {
    Survey s = fly(20000, heading);
    s.points.attributes.set("scan_angle", s.angle);
    s.points.attributes.set("gps_time", s.time);
    s.points.attributes.set("point_source_id", s.line);
    const std::vector<Vec3f> found = directions_to_flight(s.points);
    ASSERT_EQ(found.size(), s.points.size());
    EXPECT_GT(least_cosine(found, s.towards), std::cos(3 * kDegree));
  }
}

TEST(FlightLines, LinesAreToldApartByNumberOrByPause) {
  Survey s = fly(20000, 100);
  PointSet by_time = s.points, by_line = s.points, turned = s.points, neither = s.points;
  by_time.attributes.set("ScanAngleRank", s.angle);  // names of PDAL
  by_time.attributes.set("GpsTime", s.time);
  EXPECT_GT(least_cosine(directions_to_flight(by_time), s.towards), std::cos(3 * kDegree));
  by_line.attributes.set("scan_angle", s.angle);
  by_line.attributes.set("point_source_id", s.line);
  EXPECT_GT(least_cosine(directions_to_flight(by_line), s.towards), std::cos(3 * kDegree));
  // The sign convention of the angles does not matter.
  std::vector<float> negative = s.angle;
  for (float& a : negative) a = -a;
  turned.attributes.set("scan_angle", negative);
  turned.attributes.set("point_source_id", s.line);
  EXPECT_GT(least_cosine(directions_to_flight(turned), s.towards), std::cos(3 * kDegree));
  // For mixed lines of opposite directions, angles are not informative.
  neither.attributes.set("scan_angle", s.angle);
  EXPECT_TRUE(directions_to_flight(neither).empty());
  EXPECT_TRUE(directions_to_flight(s.points).empty());
}

TEST(FlightLines, TheNearWallIsSeen) {
  // A flight along x at y = -80: walls in the planes y = const face it, regardless of roofs and ground.
  Survey s = fly(30000, 0, 0);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0, 1);
  PointSet& p = s.points;
  for (int i = 0; i < 8000; ++i) {
    const float x = 40 * u(random), z = 40 + 40 * u(random), side = i % 2 ? 1.0f : -1.0f;
    p.positions.push_back({x, -80 + side * 250, z});
    p.normals.push_back({0, -side, 0});  // towards the path
    s.angle.push_back(std::round(static_cast<float>(std::atan(-side * 250 / (900 - z)) / kDegree)));
    s.time.push_back(240006);
    s.line.push_back(11);
  }
  p.attributes.set("scan_angle", s.angle);
  p.attributes.set("point_source_id", s.line);
  const std::vector<Vec3f> truth = p.normals;
  scramble_signs(p, 4);
  Progress progress;
  EXPECT_EQ(orient_normals(p, {}, progress), OrientBy::flight);
  EXPECT_EQ(fraction_correct(p, truth), 1);
}

PointSet hills(std::size_t n, float noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 400);
  std::normal_distribution<float> g;
  PointSet points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = u(random), y = u(random);
    const Vec3 p{x, y, hill_height(x, y)};
    points.positions.push_back(Vec3f(p) + Vec3f{g(random), g(random), g(random)} * noise);
    points.normals.emplace_back(hill_normal(p));
  }
  return points;
}

TEST(HeightField, TerrainIsOneSheet) {
  // Noise of a tenth of the spacing (2.8), and of one spacing.
  for (const float noise : {0.28f, 2.8f}) {
    const HeightFieldShape shape = measure_height_field(hills(20000, noise, 5), static_cast<double>(noise));
    EXPECT_GT(shape.one_sheet, 0.9) << noise;
    EXPECT_TRUE(is_height_field(shape, false)) << noise;
  }
  // Half of it is under trees.
  PointSet forest = hills(20000, 0.1f, 6);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0, 1);
  for (Vec3f& p : forest.positions)
    if (p.x < 200) p.z += 15 * u(random);
  const HeightFieldShape shape = measure_height_field(forest, 0.1);
  EXPECT_NEAR(shape.one_sheet, 0.5, 0.1);
  EXPECT_TRUE(is_height_field(shape, false));
}

TEST(HeightField, WhatHasAnUndersideIsNone) {
  std::mt19937 random(8);
  std::normal_distribution<float> g;
  EXPECT_LT(measure_height_field(sample_sphere(20000, 1, 0, 9), 0).one_sheet, 0.05);
  EXPECT_LT(measure_height_field(sample_torus(20000, 1, 0.3f, 10), 0).one_sheet, 0.05);
  const float spacing = std::sqrt(8.0f / 20000);
  for (const float thick : {2.0f, 3.0f, 6.0f})
    for (const float noise : {0.0f, 0.2f}) {
      PointSet plate = sample_box(20000, {1, 1, 0.5f * thick * spacing}, 11);
      for (Vec3f& p : plate.positions) p += Vec3f{g(random), g(random), g(random)} * (noise * spacing);
      // Also with both sheets interpreted as noise.
      for (const double said : {0.0, static_cast<double>(0.5f * thick * spacing)})
        EXPECT_FALSE(is_height_field(measure_height_field(plate, said), true)) << thick << " " << noise << " " << said;
    }
  // A façade is upright.
  EXPECT_FALSE(is_height_field(measure_height_field(sample_box(20000, {1, 0.001f, 1}, 12), 0), true));
  EXPECT_EQ(measure_height_field({}, 0).one_sheet, 0);
}

TEST(Orientation, TerrainWithStraysLooksUp) {
  for (const bool valley : {false, true}) {
    PointSet cloud = hills(30000, 0.05f, 13);
    if (valley)
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        Vec3f& p = cloud.positions[i];
        p.z = 0.001f * ((p.x - 200) * (p.x - 200) + (p.y - 200) * (p.y - 200));
        cloud.normals[i] = normalized(Vec3f{-0.002f * (p.x - 200), -0.002f * (p.y - 200), 1});
      }
    const std::size_t ground = cloud.size();
    std::mt19937 random(14);
    std::uniform_real_distribution<float> u(0, 400);
    for (std::size_t i = 0; i < ground / 100; ++i) {
      cloud.positions.push_back({u(random), u(random), u(random) * 0.25f - 20});
      cloud.normals.push_back(random_direction(random));
    }
    const auto upward = [&](const PointSet& p) {
      std::size_t count = 0;
      for (std::size_t i = 0; i < ground; ++i) count += p.normals[i].z > 0;
      return count;
    };
    Progress progress;
    // Given normals stay unchanged.
    EXPECT_EQ(measure_orientation(cloud, {}, false).check, OrientationCheck::oriented);
    const PreparedCloud kept = prepare_cloud(cloud, {}, progress);
    EXPECT_EQ(kept.points.normals, cloud.normals);
    EXPECT_FALSE(kept.oriented_by);
    EXPECT_TRUE(kept.notes.empty());
    // Normals that all point down also stay: an open sheet has no outside.
    PointSet downward = cloud;
    for (Vec3f& n : downward.normals) n = -n;
    EXPECT_EQ(prepare_cloud(downward, {}, progress).points.normals, downward.normals);
    // Other normals point up.
    CloudPreparation anew;
    anew.normals = NormalUse::estimate;
    const PreparedCloud estimated = prepare_cloud(cloud, anew, progress);
    EXPECT_EQ(estimated.oriented_by, OrientBy::up);
    EXPECT_GT(upward(estimated.points), ground - ground / 1000);
    scramble_signs(cloud, 15);
    EXPECT_EQ(upward(prepare_cloud(cloud, {}, progress).points), ground);
  }
}

/// A free-standing wall seen by two scanners in front of and behind it: two sheets, `thick` apart, with windows.
PointSet facade(float thick, float noise, std::vector<Vec3f>& truth) {
  std::mt19937 random(16);
  std::uniform_real_distribution<float> u(-10, 10);
  std::normal_distribution<float> g;
  PointSet points;
  points.scanners = {{3, -15, 1}, {-4, 12, 2}};
  while (points.size() < 40000) {
    const Vec3f p{u(random), 0, 0.5f * u(random)};
    if (std::abs(std::remainder(p.x, 4.0f)) < 1 && std::abs(p.z - 2) < 1) continue;  // a window
    const auto scan = static_cast<std::uint16_t>(random() % 2);
    const float side = scan == 0 ? -1.0f : 1.0f;
    points.positions.push_back(p + Vec3f{0, side * thick / 2, 0} + Vec3f{g(random), g(random), g(random)} * noise);
    points.scan_of_point.push_back(scan);
    truth.push_back({0, side, 0});
  }
  return points;
}

TEST(Orientation, BothSidesOfAThinWallLookAtTheirScanners) {
  const float spacing = std::sqrt(2 * 200.0f * 0.8f / 40000);
  for (const float thick : {1.5f, 3.0f}) {
    std::vector<Vec3f> truth;
    PointSet points = facade(thick * spacing, 0.1f * spacing, truth);
    points.normals = truth;
    scramble_signs(points, 17);
    Progress progress;
    PointSet blind = points;
    EXPECT_EQ(orient_normals(points, {}, progress), OrientBy::scanner);
    EXPECT_EQ(fraction_correct(points, truth), 1) << thick;
    EXPECT_EQ(orient_normals(blind, {.by = OrientBy::propagation}, progress), OrientBy::propagation);
  }
}

TEST(Orientation, SidesOfAThinPlateAreTwoSurfaces) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others orient thin walls, too");
  // The sides are three spacings apart; away from the rim, where noise randomises normals, no sign is wrong.
  const std::size_t n = 20000;
  const float spacing = std::sqrt(8.0f / static_cast<float>(n));
  for (const float noise : {0.0f, 0.1f, 0.2f, 0.3f}) {
    PointSet points = sample_box(n, {1, 1, 1.5f * spacing}, 18);
    std::mt19937 random(19);
    std::normal_distribution<float> g;
    for (Vec3f& p : points.positions) p += Vec3f{g(random), g(random), g(random)} * (noise * spacing);
    const std::vector<Vec3f> truth = points.normals;
    const auto wrong_inside = [&] {
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const bool inside =
            std::max(std::abs(points.positions[i].x), std::abs(points.positions[i].y)) < 1 - 3 * spacing;
        wrong += inside && dot(points.normals[i], truth[i]) < -0.5f;
      }
      return wrong;
    };
    scramble_signs(points, 20);
    Progress progress;
    EXPECT_EQ(orient_normals(points, {}, progress), OrientBy::propagation);
    EXPECT_LE(wrong_inside(), 2u) << noise;
    EXPECT_GT(fraction_correct(points, truth), 0.9995) << noise;
    estimate_normals(points, {}, progress);
    EXPECT_EQ(orient_normals(points, {}, progress), OrientBy::propagation);
    EXPECT_LE(wrong_inside(), n / 1000) << noise;
    EXPECT_GT(fraction_correct(points, truth), 0.99) << noise;
  }
}

TEST(Orientation, AScannerThatCannotHaveSeenTheCloudIsNotBelieved) {
  // A complete ball is not visible from any single position.
  PointSet points = sample_sphere(6000, 1, 0, 21);
  const std::vector<Vec3f> truth = points.normals;
  points.scanners = {{5, 0, 0}};
  points.scan_of_point.assign(points.size(), 0);
  Progress progress;
  PreparedCloud kept = prepare_cloud(points, {}, progress);
  EXPECT_EQ(kept.points.normals, truth);
  EXPECT_FALSE(kept.oriented_by);
  scramble_signs(points, 22);
  EXPECT_EQ(orient_normals(points, {}, progress), OrientBy::propagation);
  EXPECT_EQ(points.normals, truth);
  // If requested, the scanner decides anyway.
  orient_normals(points, {.by = OrientBy::scanner}, progress);
  const std::vector<Vec3f> directions = find_sensor_directions(points, OrientBy::scanner);
  EXPECT_LT(share_facing_away(points, directions), 0.15);
}

TEST(Orientation, GivenNormalsThatLookAwayFromTheirScannerAreTurned) {
  // A room seen from within, with inward and with outward normals.
  PointSet room = sample_box(12000, {3, 2, 1}, 23);
  room.scanners = {{0.4f, 0.2f, 0}};
  room.scan_of_point.assign(room.size(), 0);
  const std::vector<Vec3f> outward = room.normals;
  PointSet seen = room;
  for (Vec3f& n : seen.normals) n = -n;
  Progress progress;
  const PreparedCloud turned = prepare_cloud(room, {}, progress), kept = prepare_cloud(seen, {}, progress);
  EXPECT_EQ(turned.points.normals, seen.normals);
  EXPECT_EQ(turned.oriented_by, OrientBy::scanner);
  ASSERT_EQ(turned.notes.size(), 1u);
  EXPECT_NE(turned.notes[0].text.find("12,000 normals flipped"), std::string::npos) << turned.notes[0].text;
  EXPECT_EQ(kept.points.normals, seen.normals);
  EXPECT_FALSE(kept.oriented_by);
  EXPECT_TRUE(kept.notes.empty());
  // Without a scanner the normals of a closed shape point outward.
  seen.scanners.clear(), seen.scan_of_point.clear();
  EXPECT_EQ(prepare_cloud(seen, {}, progress).points.normals, outward);
}

TEST(Orientation, SamplesOfUnknownScansFollowTheOthers) {
  std::vector<Vec3f> truth;
  PointSet points = facade(1, 0, truth);
  points.normals = truth;
  for (std::size_t i = 0; i < points.size(); i += 3) points.scan_of_point[i] = 65535;
  scramble_signs(points, 24);
  Progress progress;
  EXPECT_EQ(orient_normals(points, {}, progress), OrientBy::scanner);
  EXPECT_EQ(fraction_correct(points, truth), 1);
}

TEST(Orientation, WhatIsAskedForDecides) {
  PointSet points = sample_sphere(4000, 1, 0, 25);
  Progress progress;
  CloudPreparation use;
  use.orient_by = OrientBy::up;
  const PreparedCloud up = prepare_cloud(points, use, progress);
  EXPECT_EQ(up.oriented_by, OrientBy::up);
  EXPECT_LT(share_facing_away(up.points, find_sensor_directions(up.points, OrientBy::up)), 0.15);
  for (const OrientBy by : {OrientBy::scanner, OrientBy::rows, OrientBy::flight}) {
    use.orient_by = by;
    EXPECT_THROW(prepare_cloud(points, use, progress), DataError);
  }
}

TEST(Orientation, BySightsDoesNotDependOnTheNumberOfThreads) {
  SANSMESH_NOT_SANITIZED("compares results; others run the same loops");
  PointSet cloud = hills(20000, 0.5f, 26);
  std::vector<Vec3f> truth;
  PointSet wall = facade(0.3f, 0.05f, truth);
  Progress progress;
  estimate_normals(cloud, {}, progress);
  estimate_normals(wall, {}, progress);
  test::expect_equal_for_any_threads([&] {
    PointSet one = cloud, other = wall;
    orient_normals(one, {}, progress);
    orient_normals(other, {}, progress);
    return std::pair(one.normals, other.normals);
  });
}

// Runs only if ../shared exists beside the checkout; the tests above cover the same code.
TEST(ExtraOrientation, OfRealScansIsThatOfTheirSensors) {
  SANSMESH_NOT_SANITIZED("judges accuracy on large scans; others orient by sensor positions, too");
  struct Scan {
    const char* file;
    OrientBy by;
    double away;  ///< share of the normals that clearly face the sensor or away
  };
  for (const Scan& scan :
       {Scan{"kinect_capture0001.pcd", OrientBy::scanner, 0.001},
        Scan{"bunny_scans/bun.conf", OrientBy::scanner, 0.001}, Scan{"lidar_autzen_trim.las", OrientBy::flight, 0.03},
        Scan{"lidar_samp11.pcd", OrientBy::up, 0.03}}) {
    const std::string file = test::shared_points(scan.file);
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "an extra: there is no ../shared/data/points";
    PointSet points = read_points(file);
    Progress progress;
    estimate_normals(points, {}, progress);
    EXPECT_EQ(orient_normals(points, {}, progress), scan.by) << scan.file;
    EXPECT_LT(share_facing_away(points, find_sensor_directions(points, scan.by)), scan.away) << scan.file;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
