#include "sansmesh/points/orientation/winding_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "points/shapes.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Unit sphere in tree order.
std::vector<Vec3f> sphere(std::size_t n) { return KdTree(sample_sphere(n, 1, 0, 1).positions).positions(); }

TEST(WindingSums, AreThoseOfAllPairsWithinFourPercent) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{9}, std::size_t{700}}) {
    const std::vector<Vec3f> nodes = sphere(n);
    const WindingSums sums(nodes);
    const float width = 0.1f;
    std::vector<float> winding(n), ones(n, 1);
    std::vector<Vec3f> outward(n), transposed(n);
    sums.winding(nodes, width, winding);
    sums.gradient(nodes, width, outward);
    sums.transposed(ones, width, transposed);
    for (std::size_t i = 0; i < n; ++i) {
      double w = 0;
      Vec3 gradient, sum;
      for (const Vec3f& p : nodes) {
        const Vec3 d(p - nodes[i]), a(p);
        const double r2 = squared_norm(d) + static_cast<double>(width) * static_cast<double>(width);
        const double r3 = r2 * std::sqrt(r2) * 4 * std::numbers::pi;
        w += dot(d, a) / r3, gradient += (a - d * (3 * dot(d, a) / r2)) / r3, sum -= d / r3;
      }
      const auto all = static_cast<double>(n);
      EXPECT_NEAR(static_cast<double>(winding[i]), w, 0.04 * all / (4 * std::numbers::pi));
      EXPECT_LT(norm(Vec3(outward[i]) - gradient), 0.04 * norm(gradient) + 1e-4);
      EXPECT_LT(norm(Vec3(transposed[i]) - sum), 0.04 * all / (4 * std::numbers::pi));
    }
  }
}

TEST(WindingSums, OfCoincidentNodesAreZero) {
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{10000}}) {
    const WindingSums sums(std::vector<Vec3f>(n, Vec3f{0.1f, 0.7f, 0.3f}));
    std::vector<float> winding(n, 1), ones(n, 1);
    std::vector<Vec3f> area(n, Vec3f{0, 0, 1}), transposed(n);
    const float width = 0.1f;
    sums.winding(area, width, winding);
    sums.transposed(ones, width, transposed);
    // Rounding moves the centres of groups.
    const float largest = 1e-5f * static_cast<float>(n) / (4 * std::numbers::pi_v<float> * width * width);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_LE(std::abs(winding[i]), largest);
      EXPECT_LE(norm(transposed[i]), largest);
    }
  }
}

TEST(WindingSums, OfAClosedSurfaceAreAHalf) {
  const std::size_t n = 5000;
  const std::vector<Vec3f> nodes = sphere(n);
  std::vector<Vec3f> area(n);
  for (std::size_t i = 0; i < n; ++i) area[i] = nodes[i] * (4 * std::numbers::pi_v<float> / static_cast<float>(n));
  std::vector<float> winding(n);
  WindingSums(nodes).winding(area, 0.05f, winding);
  double mean = 0;
  for (const float w : winding) mean += static_cast<double>(w) / static_cast<double>(n);
  EXPECT_NEAR(mean, 0.5, 0.05) << "the smoothing takes half the width over the radius";
}

}  // namespace
}  // namespace sansmesh::inline v1::detail
