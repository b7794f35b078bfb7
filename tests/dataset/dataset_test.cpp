#include "sansmesh/dataset/volume_dataset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "support/clean_text.h"
#include "volume/volume_grids.h"

namespace sansmesh::inline v1 {
namespace {

GridData with_arrays() {
  GridData data = test::lattice_grid({5, 6, 7}, test::linear_function);
  GridBlock& block = data.blocks[0];
  const std::size_t n = test::block_point_count(block);
  std::vector<std::int32_t> ids(n);
  std::vector<float> vectors(3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    ids[i] = static_cast<std::int32_t>(i);
    const Vec3 x = test::block_point(block, i);
    for (std::size_t k = 0; k < 3; ++k) vectors[3 * i + k] = static_cast<float>(x[k]);
  }
  AttributeTable arrays;
  arrays.set("ids", std::move(ids));
  arrays.set("where", std::move(vectors), 3);
  arrays.set("constant", std::vector<double>(n, 2.5));
  for (const Attribute& a : block.point_arrays) arrays.set(a);
  block.point_arrays = std::move(arrays);
  return data;
}

TEST(VolumeDataset, DefaultIsTheFirstVaryingRealScalar) {
  const VolumeDataset dataset(with_arrays());
  EXPECT_EQ(dataset.default_array().name, "f");
  EXPECT_EQ(dataset.default_array().of, Association::points);
  EXPECT_EQ(dataset.array("ids").most[0], 5 * 6 * 7 - 1);
  EXPECT_EQ(dataset.array("where").components, 3u);
}

TEST(VolumeDataset, FindsComponentsByNumberAndName) {
  const VolumeDataset dataset(with_arrays());
  EXPECT_FALSE(dataset.choose("where").component);
  EXPECT_EQ(*dataset.choose("where:2").component, 2u);
  EXPECT_EQ(*dataset.choose("where:y").component, 1u);
  EXPECT_TRUE(dataset.choose("where:magnitude").magnitude);
}

TEST(VolumeDataset, ReportsTheMemoryOfAField) {
  VolumeDataset dataset(with_arrays());
  const auto bytes_of = [&](const std::string& method) {
    VolumeReconstructionOptions options;
    options.method = method;
    Progress progress;
    VolumeReconstructionReport report;
    dataset.field({"where", {}, false}, options, progress, &report);
    return report.bytes;
  };
  // All arrays of the samples, the axes of the lattice, and the values of the reconstructed array.
  std::size_t arrays = 0;
  Progress progress;
  for (const Attribute& a : dataset.volume(Association::points, progress)->attributes)
    std::visit([&](const auto& values) { arrays += values.size() * sizeof(values[0]); }, a.values);
  const std::size_t linear = bytes_of("linear"), numbers = 5 * 6 * 7 * 3;
  EXPECT_NEAR(static_cast<double>(linear), static_cast<double>(arrays + (5 + 6 + 7 + numbers) * sizeof(double)), 100);
  // At least a constant and three slopes more per sample and component.
  EXPECT_GT(bytes_of("mls-detail"), linear + numbers * (8 + 3 * 4));
}

TEST(VolumeDataset, ErrorsNameAvailableArrays) {
  const VolumeDataset dataset(with_arrays());
  const auto message_of = [&](const std::string& text) {
    try {
      dataset.choose(text);
    } catch (const ArgumentError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message_of("nothing").find("ids, where, constant, f"), std::string::npos);
  EXPECT_NE(message_of("where:3").find("0 to 2"), std::string::npos);
  EXPECT_NE(message_of("where:w"), "");
  EXPECT_THROW(VolumeDataset(GridData{}).default_array(), DataError);
}

TEST(VolumeDataset, MagnitudesAreThoseOfTheVectorWithTheirGradients) {
  VolumeDataset dataset(with_arrays());
  Progress progress;
  VolumeReconstructionOptions linear;
  linear.method = "linear";
  const auto field = dataset.field(dataset.choose("where:magnitude"), linear, progress);
  const auto y = dataset.field(dataset.choose("where:y"), linear, progress);
  ASSERT_EQ(field->components(), 1u);
  const std::vector<Vec3> x{{0.3, 0.4, 0.5}, {0.9, 0.1, 0.2}};
  std::vector<double> values(2), of_y(2);
  std::vector<Vec3> gradients(2);
  field->evaluate(x, {values, gradients});
  y->evaluate(x, {of_y});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(values[i], norm(x[i]), 1e-6);
    EXPECT_NEAR(norm(gradients[i] - x[i] / norm(x[i])), 0, 1e-5);
    EXPECT_NEAR(of_y[i], x[i].y, 1e-6);
  }
}

TEST(IsosurfaceName, IsAFileWithAnArrayAndAValueInBrackets) {
  const auto name = parse_isosurface_name("some/data.vtu[Temp=300]");
  ASSERT_TRUE(name);
  EXPECT_EQ(name->file, "some/data.vtu");
  EXPECT_EQ(name->array, "Temp");
  EXPECT_EQ(name->value, 300);
  EXPECT_EQ(parse_isosurface_name("d[1].vti[V:magnitude=-2.5e-3]")->value, -2.5e-3);
  EXPECT_EQ(parse_isosurface_name("d[1].vti[V:magnitude=-2.5e-3]")->array, "V:magnitude");
  EXPECT_FALSE(parse_isosurface_name("data.vtu"));
  EXPECT_FALSE(parse_isosurface_name("scan[3]"));
  for (const char* bad : {"data.vtu[Temp=]", "data.vtu[=3]", "[Temp=3]", "data.vtu[Temp=3x]", "data.vtu[Temp=nan]"})
    EXPECT_THROW(parse_isosurface_name(bad), ArgumentError) << bad;
}

TEST(IsosurfaceName, MessagesQuoteAnythingInOnePrintableLine) {
  try {
    parse_isosurface_name("data.vtu[T\x05\n\xff=" + std::string(10000, 'x') + "]");
    FAIL();
  } catch (const ArgumentError& error) {
    EXPECT_TRUE(test::is_clean(error.what()));
    EXPECT_LT(std::string(error.what()).size(), 1000u);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
