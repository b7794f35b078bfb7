#include "sansmesh/partition/edit/changed_regions.h"

#include <cstddef>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMostRegions = 64;
/// Initial number of cells along a side of the cube.
constexpr int kRegionCells = 32;
/// Touching boxes are merged if their union is at most this many times larger.
constexpr float kGrowth = 1.2f;

std::vector<Box3f> joined_in_cells(const std::vector<Box3f>& boxes, const Box3f& cube, int cells) {
  const auto n = static_cast<std::size_t>(cells);
  std::vector<Box3f> of_cell(n * n * n);
  for (const Box3f& box : boxes) {
    std::size_t cell = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float x = (box.center()[k] - cube.lower[k]) / (cube.upper[k] - cube.lower[k]) * static_cast<float>(cells);
      cell = cell * n + index_in<std::size_t>(x, 0, cells - 1);
    }
    of_cell[cell].extend(box);
  }
  std::erase_if(of_cell, [](const Box3f& b) { return b.empty(); });
  return of_cell;
}

}  // namespace

std::vector<Box3f> changed_regions(const std::vector<Box3f>& boxes, const Box3f& cube) {
  std::vector<Box3f> regions;
  for (int cells = kRegionCells; cells >= 1; cells /= 2) {
    regions = joined_in_cells(boxes, cube, cells);
    if (regions.size() > 4 * kMostRegions) continue;
    unite(regions, kGrowth);
    if (regions.size() <= kMostRegions) break;
  }
  return regions;
}

}  // namespace sansmesh::inline v1
