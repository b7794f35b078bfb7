// Vectors whose components are separate arrays.
#include "sansmesh/dataset/joined_arrays.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"

namespace sansmesh::test {
namespace {

std::vector<DatasetArray> named_arrays(std::initializer_list<const char*> names) {
  std::vector<DatasetArray> arrays;
  for (const char* const name : names)
    arrays.push_back({name, Association::points, NumberType::f32, 1, {-1.0}, {2.0}, 0});
  return arrays;
}

TEST(JoinedArrays, ComponentsAreFoundByTheirNames) {
  EXPECT_EQ(vector_components(named_arrays({"z-velocity", "rho", "y-velocity", "x-velocity"})),
            "x-velocity,y-velocity,z-velocity");
  EXPECT_EQ(vector_components(named_arrays({"u", "v", "w", "p"})), "u,v,w");
  EXPECT_EQ(vector_components(named_arrays({"BX", "BY", "BZ", "VelX", "VelY", "VelZ"})), "VelX,VelY,VelZ");
  EXPECT_EQ(vector_components(named_arrays({"flux_x", "flux_y", "flux_z"})), "flux_x,flux_y,flux_z");
  EXPECT_EQ(vector_components(named_arrays({"vx", "vy", "Bx", "By", "Bz"})), "Bx,By,Bz");
  EXPECT_EQ(vector_components(named_arrays({"vx", "vy", "p"})), "vx,vy");
  // Indices, and rows of tensors.
  EXPECT_EQ(vector_components(named_arrays({"index_x", "index_y"})), "");
  EXPECT_EQ(vector_components(named_arrays({"stress_xx", "stress_xy", "stress_xz", "stress_yy"})), "");
  // Coordinates, and letters of words.
  EXPECT_EQ(vector_components(named_arrays({"x", "y", "z"})), "");
  EXPECT_EQ(vector_components(named_arrays({"mu", "mv", "flux"})), "");
  std::vector<DatasetArray> cells = named_arrays({"vx", "vy", "vz"});
  cells[1].of = Association::cells;
  EXPECT_EQ(vector_components(cells), "");
}

GridData lattice_with_parts() {
  GridData data;
  GridBlock block;
  block.kind = GridKind::lattice;
  block.axes = {std::vector<double>{0, 1, 2}, {0, 1}, {0, 1}};
  std::vector<float> a(12), b(12);
  std::vector<std::int32_t> c(12);
  for (std::size_t i = 0; i < 12; ++i)
    a[i] = 0.5f * static_cast<float>(i), b[i] = -static_cast<float>(i), c[i] = static_cast<std::int32_t>(100 + i);
  block.point_arrays.set("a", a), block.point_arrays.set("b", b), block.point_arrays.set("c", c);
  data.blocks.push_back(block);
  return data;
}

TEST(JoinedArrays, RowsAreTheComponents) {
  GridData data = lattice_with_parts();
  join_arrays(data, "b,a");
  join_arrays(data, "a,c,b");
  join_arrays(data, "a,none");
  const AttributeTable& arrays = data.blocks[0].point_arrays;
  EXPECT_EQ(arrays.size(), 5u);
  const std::vector<float>* const two = arrays.find<float>("b,a");
  ASSERT_NE(two, nullptr);
  const std::vector<double>* const three = arrays.find<double>("a,c,b");
  ASSERT_NE(three, nullptr);
  EXPECT_EQ(arrays.find("a,c,b")->components, 3u);
  for (std::size_t i = 0; i < 12; ++i) {
    const auto x = static_cast<double>(i);
    EXPECT_EQ((*two)[2 * i], -x);
    EXPECT_EQ((*two)[2 * i + 1], 0.5 * x);
    EXPECT_EQ((*three)[3 * i], 0.5 * x);
    EXPECT_EQ((*three)[3 * i + 1], 100 + x);
    EXPECT_EQ((*three)[3 * i + 2], -x);
  }
}

TEST(JoinedArrays, ChoicesMayHaveAComponent) {
  VolumeDataset dataset(lattice_with_parts());
  const std::string before = dataset.default_array().name;
  dataset.join("a,b:magnitude");
  EXPECT_EQ(dataset.default_array().name, before);
  EXPECT_TRUE(dataset.choose("a,b:magnitude").magnitude);
  EXPECT_EQ(dataset.choose("a,b:y").component, 1u);
  const DatasetArray& joined = dataset.array("a,b");
  const auto summary = joined_array(dataset.arrays(), "a,b");
  ASSERT_TRUE(summary);
  EXPECT_EQ(joined.components, 2u);
  EXPECT_EQ(joined.least, summary->least);
  EXPECT_EQ(joined.most, summary->most);
  EXPECT_FALSE(joined_array(dataset.arrays(), "a,none"));
  EXPECT_FALSE(joined_array(dataset.arrays(), ""));
}

}  // namespace
}  // namespace sansmesh::test
