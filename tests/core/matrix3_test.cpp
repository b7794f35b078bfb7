#include "sansmesh/core/matrix3.h"

#include <gtest/gtest.h>

#include <random>

namespace sansmesh::inline v1 {
namespace {

Vec3 random_vector(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

TEST(Matrix3, SolutionsMeetTheirEquations) {
  std::mt19937_64 random(1);
  std::size_t solved = 0;
  for (int i = 0; i < 1000; ++i) {
    const Matrix3 m{random_vector(random), random_vector(random), random_vector(random)};
    const Vec3 r = random_vector(random);
    if (std::abs(m.determinant()) < 0.1) continue;
    ++solved;
    const Vec3 x = m.solve(r), y = m.solve_transposed(r);
    EXPECT_LT(norm(m.a * x.x + m.b * x.y + m.c * x.z - r), 1e-13);
    EXPECT_LT(norm(Vec3{dot(m.a, y), dot(m.b, y), dot(m.c, y)} - r), 1e-13);
  }
  EXPECT_GT(solved, 100u);
}

TEST(Matrix3, TheDeterminantIsTheVolumeOfTheColumns) {
  EXPECT_EQ((Matrix3{{2, 0, 0}, {5, 3, 0}, {7, 9, 4}}.determinant()), 24);
  EXPECT_EQ((Matrix3{{5, 3, 0}, {2, 0, 0}, {7, 9, 4}}.determinant()), -24);
  EXPECT_EQ((Matrix3{{5, 3, 0}, {10, 6, 0}, {7, 9, 4}}.determinant()), 0);
}

TEST(Matrix3, WithoutADeterminantTheAnswerIsNotFinite) {
  const Matrix3 flat{{1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_FALSE(is_finite(flat.solve({1, 2, 3})));
  EXPECT_FALSE(is_finite(flat.solve_transposed({1, 2, 3})));
}

}  // namespace
}  // namespace sansmesh::inline v1
