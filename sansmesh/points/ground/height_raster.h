// Raster of heights, with the opening of grey-scale morphology.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// Heights in square cells, row by row; NaN in empty cells.
struct HeightRaster {
  std::size_t columns = 0, rows = 0;
  std::vector<float> heights;

  std::size_t size() const { return heights.size(); }
};

/// Opening by an octagon of this radius (cells, >= 1): the least height around each centre, then the largest of these
/// around each cell. Ignores empty cells. Octagons lie around cells with a non-zero entry in `centers` only: far
/// outside of the data they would contain nothing but the objects along its border, which would survive. Cells without
/// an octagon are −infinity.
HeightRaster opened(const HeightRaster& raster, std::size_t radius, const std::vector<std::uint8_t>& centers);

/// Least heights of 2 × 2 cells.
HeightRaster halved(const HeightRaster& raster);

}  // namespace sansmesh::inline v1
