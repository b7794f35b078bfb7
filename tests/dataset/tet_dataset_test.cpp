// Conversion of volumes to tetrahedra: turned, subdivided and removed cells, and vertex numbers.
#include "sansmesh/dataset/tet_dataset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

double signed_volume(const TetMesh& m, std::size_t t) {
  const auto& [a, b, c, d] = m.tets[t];
  const std::vector<Vec3>& x = m.vertices;
  return dot(x[b] - x[a], cross(x[c] - x[a], x[d] - x[a])) / 6;
}

GridBlock cube_corners() {
  GridBlock b;
  for (int k = 0; k < 8; ++k) b.points.push_back({double(k & 1), double(k >> 1 & 1), double(k >> 2)});
  return b;
}

void add_tet(GridBlock& b, std::array<std::uint32_t, 4> t) { b.cells.add(CellShape::tetrahedron, t); }

std::string why_not(const GridData& data) {
  try {
    tet_dataset(data);
  } catch (const DataError& e) {
    return e.what();
  }
  return {};
}

TEST(TetDataset, TurnsAndRemovesCellsAndKeepsNumbers) {
  GridData data;
  GridBlock& b = data.blocks.emplace_back(cube_corners());
  b.points.insert(b.points.begin(), Vec3{9, 9, 9});  // unused point
  add_tet(b, {1, 2, 3, 5});
  add_tet(b, {1, 3, 2, 5});  // a duplicate, inverted
  add_tet(b, {8, 4, 7, 6});
  for (std::uint64_t k = 0; k < 9; ++k) b.point_numbers.push_back(10 * k + 3);
  b.point_arrays.set("warmth", std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8});
  b.cell_arrays.set("part", std::vector<std::int32_t>{4, 5, 6});
  const TetDataset d = tet_dataset(data);
  ASSERT_EQ(d.mesh.tets.size(), 2u);
  EXPECT_EQ(d.mesh.vertices.size(), 8u);
  for (std::size_t t = 0; t < 2; ++t) EXPECT_NEAR(signed_volume(d.mesh, t), 1.0 / 6, 1e-15);
  EXPECT_EQ(d.mesh.tet_attributes.find("part")->number(1), 6);
  EXPECT_EQ(d.mesh.attributes.find("warmth")->number(0), 1);
  EXPECT_EQ(d.vertex(13), 0u);
  EXPECT_EQ(d.vertex(83), 7u);
  EXPECT_THROW(d.vertex(3), DataError);  // it has no tetrahedron
  EXPECT_THROW(d.vertex(14), DataError);
  std::reverse(b.point_numbers.begin(), b.point_numbers.end());
  EXPECT_EQ(tet_dataset(data).vertex(73), 0u);
  EXPECT_EQ(tet_dataset(data).vertex(3), 7u);
  ASSERT_EQ(d.notes.size(), 3u);
  EXPECT_NE(d.notes[0].find("inside out"), std::string::npos);
  EXPECT_EQ(d.notes[1], "1 tetrahedron of the same corners as others left out");
  EXPECT_EQ(d.notes[2], "1 point without tetrahedra left out");
}

TEST(TetDataset, SubdivisionKeepsTheVolume) {
  GridData data;
  GridBlock& b = data.blocks.emplace_back(cube_corners());
  b.cells.add(CellShape::hexahedron, std::vector<std::uint32_t>{0, 1, 3, 2, 4, 5, 7, 6});
  b.points.push_back({0.5, 0.5, 2});
  b.cells.add(CellShape::pyramid, std::vector<std::uint32_t>{4, 5, 7, 6, 8});
  const TetDataset d = tet_dataset(data);
  double sum = 0;
  for (std::size_t t = 0; t < d.mesh.tets.size(); ++t) {
    EXPECT_GT(signed_volume(d.mesh, t), 0);
    sum += signed_volume(d.mesh, t);
  }
  EXPECT_NEAR(sum, 1 + 1.0 / 3, 1e-14);
  EXPECT_EQ(d.numbers[5], 5u);
  // Hidden cells do not count; several blocks do.
  b.hidden_cells = {1, 0};
  data.blocks.push_back(data.blocks[0]);
  const TetDataset two = tet_dataset(data);
  EXPECT_EQ(two.mesh.tets.size(), 4u);
  EXPECT_EQ(two.vertex(9 + 4), 5u);
}

TEST(TetDataset, ErrorsNameTheReason) {
  GridData data;
  EXPECT_EQ(why_not(data), "holds no tetrahedra");
  data.blocks.emplace_back(cube_corners()).kind = GridKind::lattice;
  EXPECT_NE(why_not(data).find("structured grid"), std::string::npos);
  data.blocks[0].kind = GridKind::unstructured;
  add_tet(data.blocks[0], {0, 1, 2, 4});
  EXPECT_EQ(why_not(data), "");
  add_tet(data.blocks[0], {0, 1, 2, 3});
  EXPECT_NE(why_not(data).find("cell 1 (counted from 0) has no volume"), std::string::npos);
  data.blocks[0].points[4].z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(why_not(data).find("point 4 (counted from 0) is not finite"), std::string::npos);
}

}  // namespace
}  // namespace sansmesh::inline v1
