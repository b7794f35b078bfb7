#include "sansmesh/deform/mls/rotation_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "deform/handle_sets.h"

namespace sansmesh::test {
namespace {

using detail::Rows3;

Eigen::Matrix3d eigen(const Rows3& a) {
  Eigen::Matrix3d m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m(static_cast<int>(i), static_cast<int>(j)) = a[i][j];
  return m;
}

/// The largest Σ R_ij B_ij of any rotation: by singular values, the smallest one with the sign of the determinant.
double most_by_svd(const Eigen::Matrix3d& b) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(b, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.singularValues()[0] + svd.singularValues()[1] + sign * svd.singularValues()[2];
}

Rows3 moments(const std::vector<Vec3>& p, const std::vector<Vec3>& q) {
  Rows3 b{};
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) b[k] += q[i] * p[i][k];
  return b;
}

/// Random points; every third set is nearly planar and every third nearly collinear, some exactly, at any scale.
std::vector<Vec3> odd_places(std::mt19937& random, int kind, std::size_t n) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-16, 0);
  const double thin = exponent(random) < -14 ? 0 : std::pow(10, exponent(random));
  std::vector<Vec3> x(n);
  for (Vec3& v : x) {
    v = {normal(random), normal(random), normal(random)};
    if (kind > 0) v.z *= thin;
    if (kind > 1) v.y *= thin;
  }
  return x;
}

TEST(RotationFit, NeverFlipsAndIsAsGoodAsAnyRotation) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-100, 100);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 10'000; ++round) {
    const std::size_t n = 2 + static_cast<std::size_t>(round % 7);
    const std::vector<Vec3> q = odd_places(random, round % 3, n);
    std::vector<Vec3> p = odd_places(random, (round / 3) % 3, n);
    if (round % 2 == 0)  // near a rotation, or a mirror image
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 mirrored{q[i].x, q[i].y, round % 4 == 0 ? -q[i].z : q[i].z};
        p[i] = turned(mirrored, {1, 2, 0.5}, round) + p[i] * 1e-3;
      }
    const double scale = std::pow(10, exponent(random));
    Rows3 b = moments(p, q);
    const Rows3 r = detail::best_rotation({b[0] * scale, b[1] * scale, b[2] * scale});
    const Eigen::Matrix3d m = eigen(r), target = eigen(b);
    ASSERT_NEAR(m.determinant(), 1, 1e-14) << round;
    ASSERT_LT((m * m.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14) << round;
    ASSERT_GT(m.cwiseProduct(target).sum(), most_by_svd(target) - 1e-12 * target.norm()) << round;
  }
}

Eigen::Matrix3d random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

TEST(RotationFit, IsAsGoodAsAnyWhereMirroredSetsAreSymmetric) {
  // Mirrored corners of boxes and rings: roots of the quartic coincide, or nearly.
  std::mt19937 random(17);
  std::uniform_real_distribution<double> u(0, 1);
  for (const double gap : {0.0, 1e-14, 1e-12, 1e-10, 1e-9, 1e-8, 3e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2}) {
    for (int round = 0; round < 600; ++round) {
      const double a = round % 3 == 0 ? 1 : round % 3 == 1 ? u(random) : std::pow(10, -12 * u(random));
      const Eigen::Matrix3d from = random_rotation(random), to = random_rotation(random);
      const Eigen::Vector3d values(1, a * (round % 2 ? 1 : 1 - gap / 3), -a * (1 - gap));
      const Eigen::Matrix3d target = to * values.asDiagonal() * from.transpose();
      Rows3 b;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) b[i][j] = target(static_cast<int>(i), static_cast<int>(j));
      const Eigen::Matrix3d m = eigen(detail::best_rotation(b));
      ASSERT_NEAR(m.determinant(), 1, 1e-14) << gap << " " << a;
      ASSERT_GT(m.cwiseProduct(target).sum(), values.sum() - 1e-12 * target.norm()) << gap << " " << a;
      // A unique optimum is found up to rounding divided by its advantage.
      ASSERT_LT((m - to * from.transpose()).norm() * (values[1] + values[2]), 3e-13) << gap << " " << a;
    }
  }
}

TEST(RotationFit, FindsTheRotationOfThinSets) {
  // For a set of thickness t the second singular value is t² of the first: the rotation about the long axis is
  // determined up to rounding over t².
  std::mt19937 random(3);
  for (const double thin : {1.0, 1e-2, 1e-3, 1e-4, 1e-5}) {
    double most = 0;
    for (int round = 0; round < 200; ++round) {
      std::vector<Vec3> q = odd_places(random, 0, 6), p(6);
      const Vec3 axis = random_places(1, static_cast<unsigned>(round))[0];
      for (std::size_t i = 0; i < 6; ++i) q[i].y *= thin, q[i].z *= thin, p[i] = turned(q[i], axis, 0.1 * round);
      const Rows3 r = detail::best_rotation(moments(p, q));
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 unit;
        unit[k] = 1;
        most = std::max(most, norm(detail::times(r, unit) - turned(unit, axis, 0.1 * round)));
      }
    }
    EXPECT_LT(most, 3e-13 / (thin * thin)) << thin;
  }
}

TEST(RotationFit, TakesTheSmallestOfEquallyGoodRotations) {
  const auto angle = [](const Rows3& r) {
    return std::acos(std::clamp((r[0].x + r[1].y + r[2].z - 1) / 2, -1.0, 1.0));
  };
  EXPECT_LT(angle(detail::best_rotation({})), 1e-7);
  for (int round = 1; round < 20; ++round) {
    const Vec3 a = normalized(random_places(1, static_cast<unsigned>(round))[0]);
    const Vec3 b = normalized(random_places(1, static_cast<unsigned>(round) + 50)[0]);
    const Rows3 r = detail::best_rotation({a * b.x, a * b.y, a * b.z});  // b aᵀ: determines only that a becomes b
    EXPECT_LT(norm(detail::times(r, a) - b), 1e-7);
    EXPECT_NEAR(angle(r), std::acos(dot(a, b)), 1e-2);
  }
}

TEST(RotationFit, SmallestTurnsTakeOneDirectionToTheOther) {
  for (unsigned round = 0; round < 20; ++round) {
    const Vec3 a = normalized(random_places(1, round)[0]), b = normalized(random_places(1, round + 50)[0]);
    const detail::SmallestTurn turn{a, b};
    EXPECT_LT(norm(turn(a) - b), 1e-14);
    EXPECT_LT(norm(turn(cross(a, b)) - cross(a, b)), 1e-14);
    const detail::SmallestTurn half{a, -a};
    EXPECT_LT(norm(half(a) + a), 1e-14);
    EXPECT_NEAR(norm(half(b)), 1, 1e-14);
  }
}

}  // namespace
}  // namespace sansmesh::test
