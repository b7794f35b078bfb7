#include "sansmesh/measure/contours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/measure/mesh_heights.h"

namespace sansmesh::inline v1 {
namespace {

/// A cone of height 10 and slope 1 in cells of 0.5.
HeightGrid cone() {
  HeightGrid grid{{60, 60}, 0.5, 1000, 2015};
  for (int r = 0; r < 60; ++r)
    for (int c = 0; c < 60; ++c)
      grid.heights.at(c, r) = static_cast<float>(10 - std::hypot((c + 0.5) * 0.5 - 15, (r + 0.5) * 0.5 - 15));
  return grid;
}

TEST(Contours, OfAConeAreClosedCircles) {
  const PolylineSet lines = contours_of(cone(), 2.5);
  const auto* const heights = lines.line_attributes.find<double>("height");
  ASSERT_TRUE(heights);
  std::size_t closed = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double height = (*heights)[i];
    const Vec3f first = lines.positions[lines.offsets[i]], last = lines.positions[lines.offsets[i + 1] - 1];
    closed += first == last;
    if (height >= 0) EXPECT_EQ(first, last) << height;
    for (std::size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; ++k) {
      const Vec3 p = lines.origin + Vec3(lines.positions[k]);
      EXPECT_NEAR(std::hypot(p.x - 1015, p.y - 2000), 10 - height, 0.06);
      EXPECT_NEAR(p.z, height, 1e-6);
    }
  }
  EXPECT_EQ(closed, 5u);  // 7.5, 5, 2.5, 0 and −2.5; lower ones end at the border
  EXPECT_EQ(lines.size(), closed + 4 * 3);
}

TEST(Contours, EndAtUnknownHeights) {
  HeightGrid grid = cone();
  for (int r = 0; r < 60; ++r) grid.heights.at(30, r) = std::numeric_limits<float>::quiet_NaN();
  const PolylineSet lines = contours_of(grid, 5);
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_NE(lines.positions[lines.offsets[i]], lines.positions[lines.offsets[i + 1] - 1]);
  EXPECT_THROW(contours_of(grid, 1e-6), ArgumentError);
}

TEST(Contours, AsDrawings) {
  const PolylineSet lines = contours_of(cone(), 5);
  EXPECT_NE(contours_svg(lines, 5).find("<path data-height=\"5\""), std::string::npos);
  const std::string dxf = contours_dxf(lines, 5);
  EXPECT_NE(dxf.find("POLYLINE\n  8\nCONTOUR_INDEX\n"), std::string::npos);
  EXPECT_NE(dxf.find(" 30\n5\n"), std::string::npos);
}

TEST(MeshHeights, AreThoseOfTheHighestTriangles) {
  TriangleMesh mesh;
  mesh.origin = {100, 200, 50};
  mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {10, 10, 10}, {0, 10, 10}, {0, 0, -5}, {10, 0, -5}, {10, 10, -5}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  Progress progress;
  const HeightGrid grid = make_mesh_heights(mesh, 1, progress);
  EXPECT_GE(grid.heights.width, 10);
  EXPECT_EQ(grid.left, 100);
  for (int r = 0; r < grid.heights.height; ++r)
    for (int c = 0; c < grid.heights.width; ++c) {
      const double x = grid.left + c + 0.5, y = grid.top - r - 0.5;
      const bool inside = x < 110 && y > 200 && y < 210;
      if (!inside)
        EXPECT_TRUE(std::isnan(grid.heights.at(c, r)));
      else
        EXPECT_NEAR(grid.heights.at(c, r), 50 + y - 200, 1e-4);
    }
}

}  // namespace
}  // namespace sansmesh::inline v1
