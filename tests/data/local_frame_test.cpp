#include "sansmesh/local_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kFloatEps = std::numeric_limits<float>::epsilon();
/// Survey coordinates in metres.
const Vec3 kSurvey{512345.678, 5403210.987, 312.345};

std::vector<Vec3> places(std::size_t n, double size, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-size, size);
  std::vector<Vec3> x(n);
  for (Vec3& p : x) p = {u(random), u(random), u(random)};
  return x;
}

double largest(const Vec3& a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

PointSet cloud_of(const std::vector<Vec3>& x, const Vec3& origin) {
  PointSet cloud;
  cloud.origin = origin;
  for (const Vec3& p : x) cloud.positions.emplace_back(p);
  cloud.scanners = {Vec3f{3, -4, 5}, cloud.positions.front()};
  return cloud;
}

TEST(LocalFrame, OfItselfChangesNoBit) {
  const LocalFrame none;
  for (const Vec3& x : places(100, 1e6)) {
    EXPECT_EQ(none.to_input(x), x);
    EXPECT_EQ(none.from_input(x), x);
  }
  EXPECT_EQ(none.to_input(0.1), 0.1);
  EXPECT_EQ(none.from_input(0.1), 0.1);
}

TEST(LocalFrame, ComesBackToWithinTheRoundingOfOneSum) {
  for (const double unit : {0x1p-40, 0x1p-3, 1.0, 0x1p7, 0x1p30})
    for (const Vec3& origin : {Vec3{}, kSurvey, Vec3{-1e9, 1e-9, 7}}) {
      const LocalFrame frame{origin, unit};
      for (const Vec3& x : places(200, 2)) {
        const Vec3 there = frame.to_input(x);
        EXPECT_LE(largest(frame.from_input(there) - x), kEps * (largest(origin) / unit + 2));
        EXPECT_LE(largest(frame.to_input(frame.from_input(there)) - there), kEps * (largest(origin) + 2 * unit));
        if (origin == Vec3{}) {
          EXPECT_EQ(frame.from_input(there), x) << "powers of two round nothing";
        }
      }
    }
}

TEST(LocalFrame, AUnitThatIsNoPowerOfTwoComesBackToWithinFewRoundings) {
  const LocalFrame frame{kSurvey, 0.3048};
  for (const Vec3& x : places(500, 100))
    EXPECT_LE(largest(frame.from_input(frame.to_input(x)) - x), 4 * kEps * (largest(kSurvey) / frame.unit + 100));
}

TEST(LocalFrame, LengthsAndBoxesFollowThePlaces) {
  const LocalFrame frame{{100, -200, 300}, 0x1p-6};
  const std::vector<Vec3> x = places(300, 3);
  const Box3 own{{-1, -2, -1.5}, {2, 1, 1.5}};
  const Box3 box = frame.to_input(own);
  EXPECT_EQ(box.lower, frame.to_input(own.lower));
  EXPECT_EQ(box.upper, frame.to_input(own.upper));
  EXPECT_LE(largest(frame.from_input(box).upper - own.upper), kEps * 300 * 0x1p6);
  std::size_t held = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double length = norm(x[i] - x[i - 1]);
    EXPECT_NEAR(norm(frame.to_input(x[i]) - frame.to_input(x[i - 1])), frame.to_input(length), 4 * kEps * 300);
    EXPECT_EQ(frame.from_input(frame.to_input(length)), length);
    held += own.contains(x[i]);
    EXPECT_EQ(box.contains(frame.to_input(x[i])), own.contains(x[i]));
  }
  EXPECT_GT(held, 10u);
  EXPECT_TRUE(frame.to_input(Box3{}).empty());
  EXPECT_TRUE(frame.to_input(Box3f{}).empty());
  EXPECT_TRUE(frame.from_input(Box3{}).empty());
  const Box3 single = frame.to_input(Box3f{{-1, -2, -1.5f}, {2, 1, 1.5f}});
  EXPECT_EQ(single.lower, box.lower);
  EXPECT_EQ(single.upper, box.upper);
}

TEST(LocalFrame, ItsUnitIsTheNextPowerOfTwo) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-60, 60);
  for (int i = 0; i < 1000; ++i) {
    const double extent = std::exp2(exponent(random));
    const LocalFrame frame = frame_for(kSurvey, extent);
    int power = 0;
    EXPECT_EQ(std::frexp(frame.unit, &power), 0.5);
    EXPECT_GT(frame.from_input(extent), 0.5 * (1 - kEps));
    EXPECT_LE(frame.from_input(extent), 1 + 64 * kEps);
    EXPECT_EQ(frame.origin, kSurvey);
  }
  for (int k = -100; k <= 100; ++k) EXPECT_EQ(frame_for({}, std::ldexp(1.0, k)).unit, std::ldexp(1.0, k));
  EXPECT_EQ(frame_for({}, 0).unit, 1);
}

/// A survey strip 100 m wide: local coordinates are float, yet keep millimetres.
TEST(LocalFrame, KeepsMillimetresAtCoordinatesOfMillions) {
  const std::vector<Vec3> x = places(2000, 50);
  const PointSet given = cloud_of(x, kSurvey);
  const LocalFrame frame = frame_for(kSurvey, 100);
  PointSet own = given;
  move_from_input(own, frame);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_LE(largest(Vec3(own.positions[i])), 0.5);
    const double error = largest(frame.to_input(Vec3(own.positions[i])) - (kSurvey + x[i]));
    EXPECT_LE(error, 50 * kFloatEps / 2 + 2 * kEps * largest(kSurvey));
    EXPECT_LE(error, 1e-5);
  }
  // Two points a millimetre apart stay apart.
  const Vec3 step{1e-3, 0, 0};
  for (const Vec3& p : x) {
    const Vec3 apart = frame.from_input(kSurvey + p + step) - frame.from_input(kSurvey + p);
    EXPECT_NEAR(frame.to_input(norm(apart)), 1e-3, 4 * kEps * largest(kSurvey));
  }
}

TEST(LocalFrame, OffsetsFromAPlaceNearTheOriginLoseNothing) {
  const LocalFrame frame{kSurvey, 0x1p7};
  for (const Vec3& p : places(200, 50)) {
    const Vec3f offset(p);
    EXPECT_EQ(frame.from_input(kSurvey, offset), Vec3(offset) * 0x1p-7);
    const Vec3 at = kSurvey + Vec3{1024, -512, 0.25};
    EXPECT_LE(largest(frame.from_input(at, offset) - frame.from_input(at + Vec3(offset))),
              2 * kEps * largest(at) * 0x1p-7);
  }
}

TEST(LocalFrame, CloudsAndMeshesMoveWithAllTheirPositionsAndNothingElse) {
  const std::vector<Vec3> x = places(300, 40);
  PointSet cloud = cloud_of(x, kSurvey);
  cloud.positions[1] = {-0.0f, 0.0f, std::numeric_limits<float>::quiet_NaN()};
  cloud.normals.assign(x.size(), Vec3f{0, 0.6f, 0.8f});
  cloud.colors.assign(x.size(), {1, 2, 3});
  cloud.attributes.set("height", std::vector<float>(x.size(), 40.0f));
  cloud.triangles = {{0, 2, 3}};
  const LocalFrame frame = frame_for(kSurvey, 80);
  ASSERT_EQ(frame.unit, 128);
  PointSet own = cloud;
  move_from_input(own, frame);
  EXPECT_EQ(own.origin, Vec3{});
  EXPECT_EQ(own.scanners[0], Vec3f(3, -4, 5) * (1.0f / 128));
  EXPECT_TRUE(std::signbit(own.positions[1].x));
  EXPECT_FALSE(std::signbit(own.positions[1].y));
  EXPECT_TRUE(std::isnan(own.positions[1].z));
  EXPECT_EQ(own.normals, cloud.normals);
  EXPECT_EQ(own.colors, cloud.colors);
  EXPECT_EQ(own.attributes, cloud.attributes);
  EXPECT_EQ(own.triangles, cloud.triangles);
  PointSet back = own;
  move_to_input(back, frame);
  EXPECT_EQ(back.origin, cloud.origin);
  EXPECT_EQ(back.scanners, cloud.scanners);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (i != 1) {
      EXPECT_EQ(back.positions[i], cloud.positions[i]) << "a power of two rounds nothing";
    }

  TriangleMesh mesh = to_mesh(cloud);
  move_from_input(mesh, frame);
  EXPECT_EQ(mesh.origin, Vec3{});
  move_to_input(mesh, frame);
  EXPECT_EQ(mesh.origin, cloud.origin);
  EXPECT_EQ(mesh.vertices[2], cloud.positions[2]);
}

TEST(LocalFrame, OtherOriginsAreTakenIn) {
  const std::vector<Vec3> x = places(500, 40);
  const LocalFrame frame{kSurvey, 64};
  TriangleMesh mesh = to_mesh(cloud_of(x, kSurvey + Vec3{100, 200, -50}));
  const TriangleMesh given = mesh;
  move_from_input(mesh, frame);
  EXPECT_EQ(mesh.origin, Vec3{});
  const double rounding = 4 * kFloatEps + 4 * kEps * largest(kSurvey) / 64;
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_LE(largest(Vec3(mesh.vertices[i]) - frame.from_input(given.origin + Vec3(given.vertices[i]))), rounding);
  // Objects with an origin in local coordinates.
  TriangleMesh own = to_mesh(cloud_of(places(500, 1), {1, 2, 3}));
  const TriangleMesh before = own;
  move_to_input(own, frame);
  for (std::size_t i = 0; i < own.vertices.size(); ++i)
    EXPECT_LE(largest(own.origin + Vec3(own.vertices[i]) - frame.to_input(before.origin + Vec3(before.vertices[i]))),
              4 * kEps * largest(kSurvey));
}

TEST(LocalFrame, AnyThreadsMoveTheSame) {
  const PointSet cloud = cloud_of(places(200000, 40), kSurvey);
  const LocalFrame frame{kSurvey + Vec3{1, 2, 3}, 0.3};
  test::expect_equal_for_any_threads([&] {
    PointSet own = cloud;
    move_from_input(own, frame);
    return own.positions;
  });
}

}  // namespace
}  // namespace sansmesh::inline v1
