// Ranges of colours and carried values stay within the data.
#include <gtest/gtest.h>

#include <algorithm>
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

}  // namespace
}  // namespace sansmesh::test
