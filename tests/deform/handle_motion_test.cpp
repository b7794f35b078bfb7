#include "sansmesh/deform/handles/handle_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 about(const Vec3& x, const Vec3& axis, const Vec3& point, double angle) {
  const Vec3 v = x - point;
  return point + v * std::cos(angle) + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1 - std::cos(angle)));
}

std::vector<Handle> turned_body(double angle, const Vec3& along) {
  const Vec3 axis = normalized(Vec3{1, 2, -0.5}), point{3, 0, 1};
  std::vector<Handle> h(5);
  const Vec3 points[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 1, 1}};
  for (std::size_t i = 0; i < h.size(); ++i) {
    h[i].p = points[i], h[i].q = about(points[i], axis, point, angle) + along;
    h[i].group = "body";
  }
  h[4].p_end = Vec3{4, 1, 1}, h[4].q_end = about(*h[4].p_end, axis, point, angle) + along;
  h[0].directions = {{{0, 0, 1}, about({0, 0, 1}, axis, {}, angle)}};
  return h;
}

TEST(HandleMotion, BeginsBeforeAndEndsAfter) {
  const std::vector<Handle> h = turned_body(1, {0.3, 0, 0});
  const std::vector<Handle> first = handles_at(h, 0), last = handles_at(h, 1);
  for (std::size_t i = 0; i < h.size(); ++i) {
    EXPECT_LT(norm(first[i].q - h[i].p), 1e-13);
    EXPECT_EQ(last[i].q, h[i].q);
    EXPECT_EQ(first[i].p, h[i].p);
  }
  EXPECT_LT(norm(*first[4].q_end - *h[4].p_end), 1e-13);
  EXPECT_LT(norm(first[0].directions[0].after - Vec3{0, 0, 1}), 1e-13);
}

TEST(HandleMotion, GroupsTurnAsBodies) {
  for (const double angle : {1e-12, 1e-4, 0.8, 0.5 * kPi, 2.5, kPi - 1e-4, kPi - 1e-7})
    for (const Vec3& along : {Vec3{}, Vec3{0.5, -1, 2}}) {
      const std::vector<Handle> h = turned_body(angle, along);
      for (const double share : {0.25, 0.5, 0.9}) {
        const std::vector<Handle> now = handles_at(h, share);
        // Distances are constant in time.
        for (std::size_t i = 0; i < h.size(); ++i)
          for (std::size_t j = 0; j < i; ++j)
            ASSERT_NEAR(norm(now[i].q - now[j].q), norm(h[i].p - h[j].p), 1e-11) << angle;
        ASSERT_NEAR(norm(*now[4].q_end - now[4].q), 2, 1e-11);
        ASSERT_NEAR(norm(now[0].directions[0].after), 1, 1e-12);
      }
    }
  // Half of the motion is half of the rotation: the pose at 0.5 equals the whole motion of half the angle.
  const std::vector<Handle> whole = turned_body(1.2, {}), half = turned_body(0.6, {});
  const std::vector<Handle> now = handles_at(whole, 0.5);
  for (std::size_t i = 0; i < now.size(); ++i) EXPECT_LT(norm(now[i].q - half[i].q), 1e-12);
  EXPECT_LT(norm(now[0].directions[0].after - half[0].directions[0].after), 1e-12);
}

TEST(HandleMotion, OthersGoStraight) {
  std::vector<Handle> h = turned_body(2, {});
  for (Handle& one : h) one.group.clear();
  const std::vector<Handle> now = handles_at(h, 0.25);
  for (std::size_t i = 0; i < h.size(); ++i) EXPECT_LT(norm(now[i].q - (h[i].p * 0.75 + h[i].q * 0.25)), 1e-14);
  // Their directions rotate by the shortest way.
  const Vec3 a = h[0].directions[0].before, b = h[0].directions[0].after, c = now[0].directions[0].after;
  const auto angle = [](const Vec3& u, const Vec3& v) { return std::atan2(norm(cross(u, v)), dot(u, v)); };
  EXPECT_NEAR(angle(a, c), 0.25 * angle(a, b), 1e-12);
  EXPECT_NEAR(angle(c, b), 0.75 * angle(a, b), 1e-12);
}

TEST(HandleMotion, WhatIsLeftOfABodyGrowsWithTheWay) {
  std::vector<Handle> h = turned_body(1, {});
  h[1].q += Vec3{0.01, 0, 0};
  const std::vector<Handle> first = handles_at(h, 0), near = handles_at(h, 1 - 1e-9);
  EXPECT_LT(norm(first[1].q - h[1].p), 1e-12);
  EXPECT_LT(norm(near[1].q - h[1].q), 1e-7);
}

}  // namespace
}  // namespace sansmesh::inline v1
