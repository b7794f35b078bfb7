#include "sansmesh/volume/cells/cell_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/cell_inverse.h"

namespace sansmesh::test {
namespace {

constexpr CellShape kShapes[] = {CellShape::tetrahedron, CellShape::pyramid, CellShape::wedge, CellShape::hexahedron};

/// A cell of each shape with randomly moved corners, much thinner along z than long.
std::vector<Vec3> some_cell(CellShape shape, std::mt19937& random, double thin) {
  static const std::vector<Vec3> kCells[] = {
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
      {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}},
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  auto corners = kCells[static_cast<std::size_t>(shape)];
  for (Vec3& x : corners) {
    for (std::size_t k = 0; k < 3; ++k) x[k] += 0.2 * static_cast<double>(random()) / 4294967296.0;
    x.z *= thin;
  }
  return corners;
}

Vec3 some_parameters(CellShape shape, std::mt19937& random) {
  const auto uniform = [&] { return 0.02 + 0.96 * static_cast<double>(random()) / 4294967296.0; };
  Vec3 u{uniform(), uniform(), uniform()};
  if (shape == CellShape::tetrahedron) return u / (1.05 + u.x + u.y + u.z);
  if (shape == CellShape::wedge) return {u.x * (1 - u.y), u.y, u.z};
  return u;
}

TEST(CellGeometry, InvertsItsShapeFunctions) {
  std::mt19937 random(1);
  for (const CellShape shape : kShapes)
    for (const double thin : {1.0, 1e-5})
      for (int i = 0; i < 200; ++i) {
        const auto corners = some_cell(shape, random, thin);
        const Vec3 u = some_parameters(shape, random);
        std::array<double, 8> weights{}, nearest{};
        shape_functions(shape, u, weights);
        Vec3 x;
        for (std::size_t c = 0; c < corners.size(); ++c) x += corners[c] * weights[c];
        auto relative = corners;
        for (Vec3& p : relative) p -= x;
        Vec3 found;
        ASSERT_TRUE(CellMap(shape, relative).invert(found));
        EXPECT_LT(norm(found - u), 1e-7);
        ASSERT_TRUE(CellInverse(shape, corners).invert(x - corners[0], found));
        EXPECT_LT(norm(found - u), 1e-7);
        EXPECT_TRUE(parameters_within(shape, found, 1e-3));
        EXPECT_LT(norm(parameters_of(shape, weights) - u), 1e-12);
        // The slow method finds the same point.
        EXPECT_LT(std::sqrt(nearest_in_cell(shape, relative, nearest)), 1e-6 * thin);
        EXPECT_LT(norm(parameters_of(shape, nearest) - u), 1e-4);
      }
}

TEST(CellGeometry, NearestPointIsTheNearest) {
  std::mt19937 random(2);
  for (const CellShape shape : kShapes)
    for (int i = 0; i < 30; ++i) {
      const Vec3 x{3 * std::cos(0.7 * i), 3 * std::sin(0.7 * i), -2 + 0.15 * i};
      auto corners = some_cell(shape, random, 1);
      for (Vec3& p : corners) p -= x;
      std::array<double, 8> weights{};
      const double distance = std::sqrt(nearest_in_cell(shape, corners, weights));
      Vec3 there;
      double sum = 0;
      for (std::size_t c = 0; c < corners.size(); ++c) there += corners[c] * weights[c], sum += weights[c];
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_NEAR(norm(there), distance, 1e-9);
      for (int k = 0; k < 500; ++k) {
        shape_functions(shape, some_parameters(shape, random), weights);
        Vec3 other;
        for (std::size_t c = 0; c < corners.size(); ++c) other += corners[c] * weights[c];
        ASSERT_GE(norm(other), distance - 1e-6);
      }
    }
}

TEST(CellGeometry, RejectedPointsAreOutOfReach) {
  std::mt19937 random(4);
  const auto uniform = [&] { return 2.4 * static_cast<double>(random()) / 4294967296.0 - 0.6; };
  for (const CellShape shape : kShapes)
    for (const double thin : {1.0, 1e-3}) {
      int ruled_out = 0;
      for (int i = 0; i < 400; ++i) {
        auto corners = some_cell(shape, random, thin);
        const Vec3 x{uniform(), uniform(), thin * uniform()};
        const Vec3 from_corner = x - corners[0];
        const CellInverse inverse(shape, corners);
        for (Vec3& p : corners) p -= x;
        for (const double reach : {0.0, 0.1 * thin}) {
          if (inverse.may_reach(from_corner, reach)) continue;
          ++ruled_out;
          std::array<double, 8> weights{};
          EXPECT_GT(std::sqrt(nearest_in_cell(shape, corners, weights)), reach);
        }
      }
      if (shape == CellShape::hexahedron) EXPECT_GT(ruled_out, 200);
    }
}

TEST(CellGeometry, VolumeIsThatOfTheMap) {
  // The integral of the Jacobian, a polynomial of degree two in each parameter, by three-point Gauss quadrature.
  constexpr double kAt[] = {0.1127016653792583, 0.5, 0.8872983346207417}, kWeight[] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const auto corners = some_cell(CellShape::hexahedron, random, 1);
    const CellMap map(CellShape::hexahedron, corners);
    double sum = 0;
    for (int q = 0; q < 27; ++q) {
      const auto d = map.derivatives({kAt[q % 3], kAt[q / 3 % 3], kAt[q / 9]});
      sum += kWeight[q % 3] * kWeight[q / 3 % 3] * kWeight[q / 9] * dot(cross(d[0], d[1]), d[2]);
    }
    EXPECT_NEAR(cell_volume(CellShape::hexahedron, corners), sum, 1e-12);
  }
}

TEST(BoxTree, FindsWhatBruteForceFinds) {
  std::mt19937 random(4);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Box3> boxes;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 a{1e6 + uniform(), uniform(), uniform()};
    boxes.push_back({a, a + Vec3{0.1 * uniform(), 1e-6 * uniform(), 0.1 * uniform()}});
  }
  boxes[17] = {};  // empty
  const BoxTree tree(boxes.size(), [&](std::size_t i) { return boxes[i]; });
  std::vector<std::uint32_t> found;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x =
        i % 2 ? boxes[static_cast<std::size_t>(i) + 20].center() : Vec3{1e6 + uniform(), uniform(), uniform()};
    tree.containing(x, found);
    std::sort(found.begin(), found.end());
    double least = 1e300;
    std::uint32_t nearest = BoxTree::kNone;
    const auto distance = [&](std::uint32_t b) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = std::max({boxes[b].lower[k] - x[k], x[k] - boxes[b].upper[k], 0.0});
        sum += d * d;
      }
      return sum;
    };
    for (std::uint32_t b = 0; b < boxes.size(); ++b) {
      if (boxes[b].empty()) continue;
      if (boxes[b].contains(x)) ASSERT_TRUE(std::binary_search(found.begin(), found.end(), b));
      if (distance(b) < least) least = distance(b), nearest = b;
    }
    EXPECT_EQ(tree.nearest(x, distance, 1e300), nearest);
  }
}

}  // namespace
}  // namespace sansmesh::test
