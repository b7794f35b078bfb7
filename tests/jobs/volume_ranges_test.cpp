// Ranges of colours and carried values stay within the data.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/isosurfaces.h"
#include "sansmesh/volume_pictures.h"
#include "sansmesh/volumes.h"
#include "volume/volume_grids.h"

namespace sansmesh::test {
namespace {

/// Values in cells that rise towards the surface of the volume, where half a cell is extrapolated; positive.
VolumeModel rising() {
  const auto f = [](const Vec3& x) { return 1 + 254 * x.x * x.x * x.x; };
  GridData data = bent_grid({9, 9, 9}, f);
  std::vector<double> other;
  const CellList cells = block_cells(data.blocks[0]);
  for (std::size_t c = 0; c < cells.size(); ++c) other.push_back(data.blocks[0].points[cells[c][0]].y);
  data.blocks[0].cell_arrays.set("height", std::move(other));
  data.blocks[0].point_arrays.clear();
  VolumeModelOptions options;
  options.array = "f";
  return {std::move(data), "made", options};
}

TEST(VolumeRanges, OfColoursAreWithinTheData) {
  Progress progress;
  const VolumeModel volume = rising();
  const DatasetArray& array = volume.array();
  VolumePicturesOptions options;
  options.look.picture.view.width = 240, options.look.picture.view.height = 100;
  VolumePictures pictures(volume, options, {}, progress);
  pictures.render(pictures.look().picture.view.direction, progress);
  const auto [lower, upper] = pictures.report().transfer.range();
  EXPECT_GE(lower, array.least[0] * (1 - 1e-6));
  EXPECT_LE(upper, array.most[0] * (1 + 1e-6));
}

TEST(VolumeRanges, OfCarriedArraysAreWithinTheData) {
  Progress progress;
  const VolumeModel volume = rising();
  VolumeIsosurfaceOptions options;
  options.value = 100, options.carry = "all";
  const VolumeIsosurfaceResult made = isosurface(volume, options, progress);
  ASSERT_GT(made.mesh.triangles.size(), 30u);
  const Attribute* const height = made.mesh.attributes.find("height");
  ASSERT_NE(height, nullptr);
  for (const DatasetArray& array : volume.arrays()) {
    if (array.name != "height") continue;
    for (std::size_t i = 0; i < height->size(); ++i) {
      ASSERT_GE(height->number(i), array.least[0] - 1e-6);
      ASSERT_LE(height->number(i), array.most[0] + 1e-6);
    }
  }
}

TEST(VolumeRanges, OfResampledValuesThatExtrapolateAreWithinTheData) {
  Progress progress;
  const VolumeModel volume = rising();
  const DatasetArray& array = volume.array();
  const double range = array.most[0] - array.least[0];
  ResampleOptions options;
  options.size = {60};
  const ResampleResult made = resample(volume, options, progress);
  const std::vector<float>& values = *made.block.point_arrays.find<float>("f");
  const std::vector<std::uint8_t>& inside = *made.block.point_arrays.find<std::uint8_t>("inside");
  const std::vector<double>& x = made.block.axes[0];
  double most = 0, at_surface = 0;
  std::size_t surface = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (inside[i] == 0) continue;
    most = std::max(most, static_cast<double>(values[i]));
    ASSERT_GE(static_cast<double>(values[i]), array.least[0] * (1 - 1e-6));
    if (x[i % x.size()] < x.back() * (1 - 1e-9)) continue;
    at_surface = std::max(at_surface, static_cast<double>(values[i])), ++surface;
  }
  // The function reaches a fifth of the range more at the surface; half-way to it a part remains.
  EXPECT_LE(most, array.most[0] + 0.08 * range);
  EXPECT_GT(most, array.most[0] - 0.05 * range);
  EXPECT_LE(at_surface, array.most[0] + 0.02 * range) << surface;
}

TEST(VolumeRanges, OfResampledPositiveDecadesArePositive) {
  Progress progress;
  const auto front = [](const Vec3& x) { return x.x > 0.45 ? 1 : 1e-6; };
  for (const bool in_cells : {false, true}) {
    GridData data = lattice_grid({12, 6, 6}, front);
    (in_cells ? data.blocks[0].point_arrays : data.blocks[0].cell_arrays) = {};
    VolumeModelOptions how;
    how.array = "f";
    how.reconstruction.method = "cubic", how.reconstruction.logarithm = false;
    const VolumeModel volume(std::move(data), "made", how);
    std::vector<Vec3> x;
    for (int i = 0; i < 200; ++i) x.push_back({0.2 + 0.003 * i, 0.51, 0.49});
    std::vector<double> own(x.size());
    std::vector<Note> notes;
    volume.field(progress, notes)->query({.points = x}, {.values = own});
    EXPECT_LT(*std::min_element(own.begin(), own.end()), -0.01);
    ResampleOptions options;
    options.size = {70};
    const ResampleResult made = resample(volume, options, progress);
    for (const float v : *made.block.point_arrays.find<float>("f")) ASSERT_GE(v, 0.999e-6f);
  }
}

}  // namespace
}  // namespace sansmesh::test
