// Root cubes on a lattice that no extreme sample moves.
#include <gtest/gtest.h>

#include <cmath>

#include "sansmesh/partition/fit/scale_choice.h"
#include "sansmesh/partition/fit/sorted_samples.h"
#include "support/clouds.h"

namespace sansmesh::inline v1 {
namespace {

PartitionData cube_of(const PointSet& cloud) {
  PartitionData data;
  const Box3f box = set_root_cube(cloud, data);
  snap_root_cube(box, cloud.positions, kLeastCompany, data);
  for (const Vec3f& p : cloud.positions)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GT(p[k], data.lower[k]);
      EXPECT_LT(p[k], data.lower[k] + data.edge);
    }
  return data;
}

/// Position of a corner in blocks of a level, from 0 to 1.
double within_block(float corner, const PartitionData& data, int level) {
  const double blocks = static_cast<double>(corner) * std::exp2(level) / static_cast<double>(data.edge);
  return blocks - std::floor(blocks);
}

TEST(RootCube, HasBlocksOfTheScaleOfTheSamples) {
  for (const std::size_t n : {300u, 3000u, 30000u, 300000u}) {
    const PartitionData data = cube_of(test::sphere(n));
    const double quarters = 4 * std::log2(static_cast<double>(data.edge));
    EXPECT_NEAR(quarters, std::round(quarters), 1e-4) << n;
    PointSet cloud = test::sphere(n);
    const SampleTree tree(cloud.positions, cloud.normals, data.lower, data.edge,
                          deepest_level(cloud.positions, data.edge));
    const std::vector<double> company = tree.company();
    int level = 0;
    while (company[static_cast<std::size_t>(level) + 1] > 0.75 * kLeastCompany) ++level;
    EXPECT_GT(company[static_cast<std::size_t>(level)], 0.9 * kLeastCompany) << n;
    EXPECT_LT(company[static_cast<std::size_t>(level)], 1.6 * kLeastCompany) << n;
  }
}

TEST(RootCube, ExtremeSamplesMoveNoBlock) {
  PointSet cloud = test::torus(8000);
  const PartitionData before = cube_of(cloud);
  for (const float far : {1.4f, 1.5f, 3.0f, 7.0f}) {
    PointSet longer = cloud;
    longer.positions.push_back({far, 0.1f, -0.2f});
    longer.normals.push_back({1, 0, 0});
    const PartitionData after = cube_of(longer);
    const double ratio = std::log2(static_cast<double>(after.edge) / static_cast<double>(before.edge));
    EXPECT_NEAR(ratio, std::round(ratio), 1e-5) << far;  // the same lattice
    const int deeper = 8 + static_cast<int>(std::round(ratio));
    for (std::size_t k = 0; k < 3; ++k) {
      const double one = within_block(before.lower[k], before, 8), other = within_block(after.lower[k], after, deeper);
      EXPECT_NEAR(one, other, 0.01) << far;
    }
  }
}

TEST(RootCube, PlanesOfSymmetryAreOnNoSideOfABlock) {
  for (const std::size_t n : {1000u, 5000u, 20000u}) {
    const PartitionData data = cube_of(test::cube(n));
    for (int level = 0; level < 9; ++level)
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = within_block(-data.lower[k], data, level);
        EXPECT_GT(std::min(x, 1 - x), level < 4 ? 0.01 : 0.3) << n << " level " << level;
      }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
