#include "sansmesh/points/ground/ground_seeds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/ground/height_raster.h"

namespace sansmesh::inline v1 {
namespace {

/// Least slope of the sides of objects: drop over window. Low, as later steps recover terrain.
constexpr double kSeedSlope = 0.1;
/// Tolerance for the slope of the trend, in cells: positions are known to a part of a cell.
constexpr double kSlopeTolerance = 0.2;
/// Largest radius of the window in cells, relative to the shorter side of the survey, and its limits. A larger part of
/// the survey is a plateau.
constexpr double kWindowShare = 1.0 / 8, kLeastWindow = 14, kLeastWindowShare = 1.0 / 4, kMostWindow = 100;
/// Radius in cells of the raster from which the next raster has cells of twice the size.
constexpr std::size_t kCoarserFrom = 16;

std::size_t largest_window(const GroundGrid& grid) {
  const auto side = static_cast<double>(std::min(grid.columns, grid.rows));
  const double least = std::min(kLeastWindow, kLeastWindowShare * side);
  return static_cast<std::size_t>(std::max(1.0, std::min(kMostWindow, std::max(least, kWindowShare * side))));
}

std::vector<std::uint8_t> halved_centers(const std::vector<std::uint8_t>& centers, const HeightRaster& of,
                                         const HeightRaster& half) {
  std::vector<std::uint8_t> result(half.size(), 0);
  for (std::size_t r = 0; r < of.rows; ++r)
    for (std::size_t c = 0; c < of.columns; ++c) result[r / 2 * half.columns + c / 2] |= centers[r * of.columns + c];
  return result;
}

/// Cell of the raster, and whether it consists of several cells of the grid.
struct RasterCell {
  std::size_t column, row;
  bool coarse;
};

/// Whether the opening lowers the surface at a sample by more than `drop`. A coarse cell has the height of its lowest
/// sample: along the edge of a roof, that is the ground. So the sample falls with a neighbouring cell, too, if it is as
/// high.
bool falls(const HeightRaster& surface, const HeightRaster& open, const RasterCell& cell, float height, double drop) {
  const auto falls_at = [&](std::size_t k) { return static_cast<double>(surface.heights[k] - open.heights[k]) > drop; };
  if (falls_at(cell.row * surface.columns + cell.column)) return true;
  if (!cell.coarse) return false;
  for (std::size_t r = cell.row - (cell.row > 0); r <= std::min(surface.rows - 1, cell.row + 1); ++r)
    for (std::size_t c = cell.column - (cell.column > 0); c <= std::min(surface.columns - 1, cell.column + 1); ++c) {
      const std::size_t k = r * surface.columns + c;
      if (falls_at(k) && static_cast<double>(height) > static_cast<double>(surface.heights[k]) - 0.5 * drop)
        return true;
    }
  return false;
}

}  // namespace

std::vector<std::uint8_t> find_ground_seeds(const PointSet& points, const GroundGrid& grid, const GroundTrend& trend) {
  HeightRaster surface{grid.columns, grid.rows, {}};
  surface.heights.assign(grid.size(), std::numeric_limits<float>::quiet_NaN());
  std::vector<double> tolerance(grid.size(), 0);
  std::vector<std::uint8_t> seeds(grid.size(), 0);
  parallel_for(0, grid.size(), 4096, [&](std::size_t i) {
    if (grid.lowest[i] == GroundGrid::kNone) return;
    const Vec3 p(points.positions[grid.lowest[i]]);
    const GroundTrend::At at = trend.empty() ? GroundTrend::At{} : trend.at(p.x, p.y);
    surface.heights[i] = static_cast<float>(p.z - at.height);
    tolerance[i] = kSlopeTolerance * grid.cell * at.slope;
    seeds[i] = 1;
  });
  const std::vector<float> heights = surface.heights;
  // `scale` cells of the grid are one of the raster. Heights of removed objects stay lowered for wider windows.
  std::vector<std::uint8_t> centers = grid.inside;
  const std::size_t most = largest_window(grid);
  std::size_t scale = 1;
  for (std::size_t radius = 1; radius * scale <= most; ++radius) {
    const HeightRaster open = opened(surface, radius, centers);
    const double drop = kSeedSlope * static_cast<double>(radius * scale) * grid.cell;
    parallel_for(0, grid.rows, 16, [&](std::size_t r) {
      for (std::size_t c = 0; c < grid.columns; ++c) {
        const std::size_t i = r * grid.columns + c;
        if (seeds[i] && falls(surface, open, {c / scale, r / scale, scale > 1}, heights[i], drop + tolerance[i]))
          seeds[i] = 0;
      }
    });
    for (std::size_t k = 0; k < surface.size(); ++k)
      if (!std::isnan(surface.heights[k])) surface.heights[k] = open.heights[k];
    if (radius < kCoarserFrom) continue;
    const HeightRaster half = halved(surface);
    centers = halved_centers(centers, surface, half);
    surface = half;
    scale *= 2, radius /= 2;
  }
  return seeds;
}

}  // namespace sansmesh::inline v1
