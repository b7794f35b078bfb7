#include "sansmesh/volume/cells/mean_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/volume/cells/cell_tetrahedra.h"

namespace sansmesh::inline v1::detail {
namespace {

struct Polyhedron {
  std::vector<Vec3> corners;
  std::vector<std::array<std::uint8_t, 3>> triangles;
};

Polyhedron cell(CellShape shape, std::vector<Vec3> corners) {
  Polyhedron p{std::move(corners), {}};
  std::vector<std::uint32_t> numbers(p.corners.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::uint32_t>((5 * i + 3) % 8);
  face_triangles(shape, numbers, p.triangles);
  return p;
}

Polyhedron warped_hexahedron() {
  return cell(
      CellShape::hexahedron,
      {{0, 0, 0}, {1, 0.1, 0}, {1.2, 1, -0.1}, {0, 0.9, 0.2}, {0.1, 0, 1}, {1, 0, 1.1}, {0.9, 1.1, 0.8}, {-0.1, 1, 1}});
}
/// A non-convex hexahedron with one corner pushed in.
Polyhedron dented_hexahedron() {
  return cell(CellShape::hexahedron,
              {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0.65, 0.65, 0.65}, {0, 1, 1}});
}
Polyhedron wedge() {
  return cell(CellShape::wedge, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1.3}, {1, 0, 1.1}});
}
Polyhedron pyramid() { return cell(CellShape::pyramid, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}, {0.4, 0.5, 1}}); }

const std::vector<Polyhedron>& shapes() {
  static const std::vector<Polyhedron> all{warped_hexahedron(), dented_hexahedron(), wedge(), pyramid()};
  return all;
}

double inner(const Polyhedron& p, const std::vector<double>& w) {
  double sum = 0;
  for (std::size_t i = 0; i < w.size(); ++i) sum += w[i] * dot(p.corners[i], {1.5, -2, 0.7});
  return sum;
}

TEST(MeanValue, ReproducesStraightFunctionsWithTheirGradients) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(0.05, 0.6);
  for (const Polyhedron& p : shapes()) {
    std::vector<double> w(p.corners.size());
    std::vector<Vec3> slopes(p.corners.size());
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3 x{part(random), part(random) / 2, part(random) / 2};  // inside all of them
      mean_value_weights(p.corners, p.triangles, x, w, slopes);
      double sum = 0;
      Vec3 place, zero, gradient;
      for (std::size_t i = 0; i < w.size(); ++i) {
        sum += w[i], place += p.corners[i] * w[i], zero += slopes[i];
        gradient += slopes[i] * dot(p.corners[i], {1.5, -2, 0.7});
      }
      ASSERT_NEAR(sum, 1, 1e-12);
      ASSERT_NEAR(norm(place - x), 0, 1e-8);
      ASSERT_NEAR(norm(zero), 0, 1e-8);
      ASSERT_NEAR(norm(gradient - Vec3{1.5, -2, 0.7}), 0, 1e-6);
    }
  }
}

TEST(MeanValue, SlopesAreDerivatives) {
  const double h = 1e-6;
  for (const Polyhedron& p : shapes()) {
    const Vec3 x{0.31, 0.22, 0.17};
    const std::size_t n = p.corners.size();
    std::vector<double> w(n), before(n), after(n);
    std::vector<Vec3> slopes(n);
    mean_value_weights(p.corners, p.triangles, x, w, slopes);
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 a = x, b = x;
      a[k] -= h, b[k] += h;
      mean_value_weights(p.corners, p.triangles, a, before, {});
      mean_value_weights(p.corners, p.triangles, b, after, {});
      for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(slopes[i][k], (after[i] - before[i]) / (2 * h), 1e-6);
    }
  }
}

TEST(MeanValue, IsLinearOnItsFacesAndContinuousThere) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Polyhedron& p : shapes()) {
    Vec3 middle;
    for (const Vec3& c : p.corners) middle += c / static_cast<double>(p.corners.size());
    const std::size_t n = p.corners.size();
    std::vector<double> w(n), inside(n);
    std::vector<Vec3> slopes(n);
    for (const auto& t : p.triangles)
      for (int trial = 0; trial < 40; ++trial) {
        std::array<double, 3> b{uniform(random), uniform(random), uniform(random)};
        if (trial == 0) b = {1, 0, 0};  // a corner
        if (trial == 1) b = {0.5, 0.5, 0};
        const double sum = b[0] + b[1] + b[2];
        Vec3 x;
        for (std::size_t k = 0; k < 3; ++k) x += p.corners[t[k]] * (b[k] /= sum);
        mean_value_weights(p.corners, p.triangles, x, w, slopes);
        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(w[t[k]], b[k], 1e-8);
        double total = 0;
        for (const double v : w) total += std::abs(v);
        ASSERT_NEAR(total, 1, 1e-8);
        for (const Vec3& s : slopes) ASSERT_TRUE(is_finite(s) && norm(s) < 1e3);
        for (const double near : {1e-9, 1e-7, 1e-5, 1e-3}) {
          mean_value_weights(p.corners, p.triangles, x + (middle - x) * near, inside, slopes);
          ASSERT_NEAR(inner(p, inside), inner(p, w), 20 * near + 1e-7);
        }
      }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1::detail
