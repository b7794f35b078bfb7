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

/// Decreases of the surface by an opening.
class Decreases {
 public:
  Decreases(const HeightRaster& surface, const HeightRaster& open) : surface_(surface), drops_(surface.size()) {
    for (std::size_t k = 0; k < drops_.size(); ++k) drops_[k] = surface.heights[k] - open.heights[k];  // or NaN
  }

  /// Largest decrease of a cell and its neighbours; 0 where nothing is known.
  std::vector<float> largest_around() const {
    const std::size_t columns = surface_.columns, rows = surface_.rows;
    std::vector<float> of_row(drops_.size(), 0), result(drops_.size(), 0);
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        float& most = of_row[r * columns + c];
        for (std::size_t k = c - (c > 0); k <= std::min(columns - 1, c + 1); ++k)
          most = std::max(most, drops_[r * columns + k]);
      }
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t j = r - (r > 0); j <= std::min(rows - 1, r + 1); ++j)
        for (std::size_t c = 0; c < columns; ++c)
          result[r * columns + c] = std::max(result[r * columns + c], of_row[j * columns + c]);
    return result;
  }

  bool falls_at(std::size_t cell, double drop) const { return static_cast<double>(drops_[cell]) > drop; }

  /// Whether a neighbour of a coarse cell falls, and a sample of the cell is as high. A coarse cell has the height of
  /// its lowest sample: along the edge of a roof, that is the ground.
  bool falls_with_neighbour(std::size_t column, std::size_t row, float height, double drop) const {
    for (std::size_t r = row - (row > 0); r <= std::min(surface_.rows - 1, row + 1); ++r)
      for (std::size_t c = column - (column > 0); c <= std::min(surface_.columns - 1, column + 1); ++c) {
        const std::size_t k = r * surface_.columns + c;
        if (falls_at(k, drop) && static_cast<double>(height) > static_cast<double>(surface_.heights[k]) - 0.5 * drop)
          return true;
      }
    return false;
  }

 private:
  const HeightRaster& surface_;
  std::vector<float> drops_;
};

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
  // 2^level cells of the grid are one of the raster. Heights of removed objects stay lowered for wider windows.
  std::vector<std::uint8_t> centers = grid.inside;
  const std::size_t most = largest_window(grid);
  unsigned level = 0;
  for (std::size_t radius = 1; radius << level <= most; ++radius) {
    const HeightRaster open = opened(surface, radius, centers);
    const double drop = kSeedSlope * static_cast<double>(radius << level) * grid.cell;
    const Decreases decreases(surface, open);
    const std::vector<float> around = level > 0 ? decreases.largest_around() : std::vector<float>{};
    parallel_for(0, grid.rows, 16, [&](std::size_t r) {
      for (std::size_t c = 0; c < grid.columns; ++c) {
        const std::size_t i = r * grid.columns + c, k = (r >> level) * surface.columns + (c >> level);
        // Most cells are far from objects.
        if (!seeds[i] || (level > 0 && !(static_cast<double>(around[k]) > drop))) continue;
        const double least = drop + tolerance[i];
        if (decreases.falls_at(k, least) ||
            (level > 0 && decreases.falls_with_neighbour(c >> level, r >> level, heights[i], least)))
          seeds[i] = 0;
      }
    });
    for (std::size_t k = 0; k < surface.size(); ++k)
      if (!std::isnan(surface.heights[k])) surface.heights[k] = open.heights[k];
    if (radius < kCoarserFrom) continue;
    const HeightRaster half = halved(surface);
    centers = halved_centers(centers, surface, half);
    surface = half;
    ++level, radius /= 2;
  }
  return seeds;
}

}  // namespace sansmesh::inline v1
