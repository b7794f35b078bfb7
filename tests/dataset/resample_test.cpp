#include "sansmesh/dataset/resample_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "volume/volume_grids.h"

namespace sansmesh::inline v1 {
namespace {

std::shared_ptr<const VolumeField> linear_field(GridData data) {
  VolumeDataset dataset(std::move(data));
  Progress progress;
  VolumeReconstructionOptions options;
  options.method = "linear";
  return dataset.field({"f", {}, false}, options, progress);
}

TEST(Resample, ReproducesLinearFunctionsAndTheirGradients) {
  const auto field = linear_field(test::bent_grid({9, 9, 9}, test::linear_function));
  ResampleOptions options;
  options.size = {20};
  options.gradients = true;
  Progress progress;
  const GridBlock block = resample_volume(*field, "f", options, progress);
  const auto& values = *block.point_arrays.find<float>("f");
  const auto& gradients = *block.point_arrays.find<float>("f_gradient");
  const auto& inside = *block.point_arrays.find<std::uint8_t>("inside");
  std::size_t within = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i] == 0) {
      EXPECT_EQ(values[i], 0);
      continue;
    }
    ++within;
    EXPECT_NEAR(static_cast<double>(values[i]), test::linear_function(test::block_point(block, i)), 1e-5);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(static_cast<double>(gradients[3 * i + k]), test::kLinearGradient[k], 1e-4);
  }
  EXPECT_GT(within, inside.size() / 3);
  EXPECT_LT(within, inside.size());
}

TEST(Resample, HasEqualStepsOrRequestedSizes) {
  const auto field =
      linear_field(test::one_block(test::lattice_block({5, 5, 5}, {0, 0, 0}, {4, 2, 1}), test::linear_function));
  Progress progress;
  ResampleOptions options;
  options.size = {41};
  const GridBlock even = resample_volume(*field, "f", options, progress);
  EXPECT_EQ(even.axes[0].size(), 41u);
  EXPECT_EQ(even.axes[1].size(), 21u);
  EXPECT_EQ(even.axes[2].size(), 11u);
  EXPECT_EQ(even.axes[0].back(), 4);
  options.size = {3, 4, 5};
  options.box = Box3{{-1, 0, 0}, {1, 1, 1}};
  options.outside = std::numeric_limits<double>::quiet_NaN();
  const GridBlock given = resample_volume(*field, "f", options, progress);
  const auto& values = *given.point_arrays.find<float>("f");
  ASSERT_EQ(values.size(), 60u);
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_FALSE(std::isnan(values[2]));
  options.size = {3, 4};
  EXPECT_THROW(resample_volume(*field, "f", options, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
