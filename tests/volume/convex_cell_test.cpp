#include "sansmesh/volume/cells/convex_cell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace sansmesh::inline v1::detail {
namespace {

TEST(ConvexCell, HasTheVolumeAndFacesOfABox) {
  ConvexCell cell;
  cell.assign_box({0, 0, 0}, {1, 2, 3});
  EXPECT_NEAR(cell.volume(), 6, 1e-14);
  std::vector<ConvexCell::FaceMoment> faces;
  cell.moments(faces);
  ASSERT_EQ(faces.size(), 6u);
  double area = 0;
  for (const auto& f : faces) area += f.area;
  EXPECT_NEAR(area, 22, 1e-13);
}

TEST(ConvexCell, IsCutAndVanishes) {
  ConvexCell cell;
  cell.assign_box({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(cell.cut({1, 0, 0}, 2, 7));
  EXPECT_TRUE(cell.cut({1, 1, 1}, 1, 7));  // a corner of the cube remains
  EXPECT_NEAR(cell.volume(), 1.0 / 6, 1e-15);
  std::vector<ConvexCell::FaceMoment> faces;
  cell.moments(faces);
  double area = 0;
  for (const auto& f : faces)
    if (f.label == 7) area += f.area;
  EXPECT_NEAR(area, std::sqrt(3.0) / 2, 1e-14);
  EXPECT_TRUE(cell.cut({1, 1, 1}, -1, 8));
  EXPECT_TRUE(cell.empty());
  EXPECT_EQ(cell.volume(), 0);
}

// The parts on both sides of each cut add up to the whole; the vector area of a closed surface is zero.
TEST(ConvexCell, PartsMakeUpTheWhole) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    ConvexCell cell;
    cell.assign_box({-1, -1, -1}, {1, 1, 1});
    double cut_off = 0;
    for (std::uint32_t k = 0; k < 25 && !cell.empty(); ++k) {
      const Vec3 n{normal(random), normal(random), normal(random)};
      const double offset = norm(n) * (0.2 + 0.5 * std::abs(normal(random)));
      ConvexCell other = cell;
      other.cut(-n, -offset, k);
      cell.cut(n, offset, k);
      cut_off += other.volume();
    }
    EXPECT_NEAR(cell.volume() + cut_off, 8, 1e-12);
  }
}

// Planes through corners, edges and faces lose no volume.
TEST(ConvexCell, AllowsPlanesThroughItsCorners) {
  ConvexCell cell;
  cell.assign_box({0, 0, 0}, {1, 1, 1});
  cell.cut({1, -1, 0}, 0, 1);
  cell.cut({0, 1, -1}, 0, 2);
  cell.cut({1, 0, -1}, 0, 3);
  cell.cut({0, 0, 1}, 1, 4);
  EXPECT_NEAR(cell.volume(), 1.0 / 6, 1e-14);
}

}  // namespace
}  // namespace sansmesh::inline v1::detail
