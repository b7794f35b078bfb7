#include "sansmesh/field/curvature_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sansmesh/error.h"
#include "support/formula_field.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kRing = 1, kTube = 0.35;

/// Signed distance to a torus around z, defined where x < `end`.
class RingField : public test::FormulaField {
 public:
  explicit RingField(double end = 10)
      : FormulaField([](const Vec3& x, Vec3& gradient) { return test::distance_to_ring(x, gradient) - kTube; }),
        end_(end) {}
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override {
    evaluate(x, values, gradients);
    for (std::size_t i = 0; i < x.size(); ++i) inside[i] = x[i].x < end_;
  }

 private:
  double end_;
};

TEST(PrincipalCurvatures, DiagonalisesTheForm) {
  const Vec3f a{1, 0, 0}, b{0, 1, 0};
  for (const float angle : {0.0f, 0.4f, 1.3f, 2.8f}) {
    const float c = std::cos(angle), s = std::sin(angle);
    const PrincipalCurvatures curvature =
        principal_curvatures_of(3 * c * c - s * s, 4 * c * s, 3 * s * s - c * c, a, b);
    EXPECT_NEAR(curvature.k1, 3, 1e-5f);
    EXPECT_NEAR(curvature.k2, -1, 1e-5f);
    EXPECT_NEAR(std::abs(dot(curvature.direction1, Vec3f{c, s, 0})), 1, 1e-5f);
    EXPECT_NEAR(dot(curvature.direction1, curvature.direction2), 0, 1e-6f);
    EXPECT_TRUE(curvature.defined);
  }
}

TEST(LevelSetCurvature, OfATorusIsTheFormula) {
  const RingField torus;
  const LevelSetCurvature curvature(torus, 0.01);
  std::vector<Vec3> x;
  std::vector<Vec3f> normals, inward;
  std::vector<double> parallel;
  for (int i = 0; i < 40; ++i) {
    const double u = 2.4 * i, v = 0.7 * i, out = std::cos(v);
    normals.push_back(Vec3f(Vec3{out * std::cos(u), out * std::sin(u), std::sin(v)}));
    inward.push_back(-normals.back());
    x.push_back(Vec3{kRing * std::cos(u), kRing * std::sin(u), 0} + Vec3(normals.back()) * kTube);
    parallel.push_back(out / (kRing + kTube * out));
  }
  std::vector<PrincipalCurvatures> found(x.size()), behind(x.size());
  curvature.evaluate(x, normals, found);
  curvature.evaluate(x, inward, behind);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_TRUE(found[i].defined);
    EXPECT_NEAR(static_cast<double>(found[i].k1), 1 / kTube, 2e-3);
    EXPECT_NEAR(static_cast<double>(found[i].k2), parallel[i], 2e-3);
    // The parallel is around the axis.
    const Vec3 around = normalized(Vec3{-x[i].y, x[i].x, 0});
    EXPECT_NEAR(std::abs(dot(Vec3(found[i].direction2), around)), 1, 1e-3);
    // Seen from inside, it is concave.
    EXPECT_NEAR(behind[i].k1, -found[i].k2, 1e-4f);
    EXPECT_NEAR(behind[i].k2, -found[i].k1, 1e-4f);
  }
}

TEST(LevelSetCurvature, IsNotKnownBesideTheDomain) {
  const RingField torus(0.5);
  const LevelSetCurvature curvature(torus, 0.01);
  const double y = std::sqrt(1.35 * 1.35 - 0.495 * 0.495);
  const std::vector<Vec3> x{{0.495, y, 0}, {0, 1.35, 0}};
  const std::vector<Vec3f> normals{normalized(Vec3f(x[0])), {0, 1, 0}};
  std::vector<PrincipalCurvatures> found(2);
  curvature.evaluate(x, normals, found);
  EXPECT_FALSE(found[0].defined);
  EXPECT_TRUE(found[1].defined);
}

TEST(LevelSetCurvature, WrongInputIsNamed) {
  const RingField torus;
  EXPECT_THROW(LevelSetCurvature(torus, 0), ArgumentError);
  const LevelSetCurvature curvature(torus, 0.01);
  std::vector<PrincipalCurvatures> found(2);
  EXPECT_THROW(curvature.evaluate(std::vector<Vec3>(2), std::vector<Vec3f>(1), found), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
