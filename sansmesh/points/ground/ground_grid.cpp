#include "sansmesh/points/ground/ground_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/ground/local_plane.h"

namespace sansmesh::inline v1 {
namespace {

/// Number of samples for the extent.
constexpr std::size_t kExtentSamples = 20000;
/// Share of samples on each side beyond which they may be far away, and width of the margin for them, relative to the
/// extent of the others.
constexpr double kFarShare = 0.002, kFarMargin = 0.25;
/// Samples per cell of the measured area.
constexpr double kAreaSamples = 4;
/// Largest number of cells per sample and of all: long tiles across the axes leave most cells empty.
constexpr double kMostCells = 8, kMostOfAll = 1u << 31;
/// Least ratio of the sides of an extent: samples on a line cover no area.
constexpr double kLeastSide = 1e-6;

/// A sample is a stray one below the ground if it is lower than nearly all cells within kStrayReach cells, by
/// kStrayDepth cells and more, after subtraction of a common plane. One cell in kStrayMajority may be as low: another
/// stray sample. Ground seen through a canopy has more of its kind.
constexpr int kStrayReach = 8;
constexpr double kStrayDepth = 1, kLeastMeanDepth = 0.5;
constexpr std::size_t kStrayMajority = 50;

double least_cell(double width, double depth, double samples) {
  return std::sqrt(width * depth / std::min(kMostCells * samples, kMostOfAll));
}

std::size_t index_of(double at, double lower, double cell, std::size_t count) {
  return index_in<std::size_t>((at - lower) / cell, 0, count - 1);
}

bool in_extent(const Vec3f& p, const SurveyExtent& e) {
  const Vec3 q(p);
  return is_finite(p) && q.x >= e.lower.x && q.x <= e.upper.x && q.y >= e.lower.y && q.y <= e.upper.y;
}

/// Area of the cells with samples, for cells that would hold kAreaSamples if all of `area` were covered.
double covered_area(const PointSet& points, const SurveyExtent& e, double area, double n) {
  const double width = e.upper.x - e.lower.x, depth = e.upper.y - e.lower.y;
  const double cell = std::max(std::sqrt(area * kAreaSamples / n), least_cell(width, depth, n));
  const auto columns = whole_part<std::size_t>(width / cell) + 1, rows = whole_part<std::size_t>(depth / cell) + 1;
  std::vector<std::uint8_t> covered(columns * rows, 0);
  for (const Vec3f& p : points.positions)
    if (in_extent(p, e))
      covered[index_of(static_cast<double>(p.y), e.lower.y, cell, rows) * columns +
              index_of(static_cast<double>(p.x), e.lower.x, cell, columns)] = 1;
  return static_cast<double>(std::count(covered.begin(), covered.end(), std::uint8_t{1})) * cell * cell;
}

/// Finds the lowest remaining sample of each cell.
void find_lowest(const PointSet& points, GroundGrid& grid) {
  grid.lowest.assign(grid.columns * grid.rows, GroundGrid::kNone);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (grid.cell_of[i] == GroundGrid::kNone) continue;
    std::uint32_t& low = grid.lowest[grid.cell_of[i]];
    if (low == GroundGrid::kNone || points.positions[i].z < points.positions[low].z)
      low = static_cast<std::uint32_t>(i);
  }
}

/// Whether the lowest sample of a cell is a stray one.
bool is_stray(const PointSet& points, const GroundGrid& grid, std::size_t cell) {
  const auto columns = static_cast<int>(grid.columns), rows = static_cast<int>(grid.rows);
  const auto column = static_cast<int>(cell % grid.columns), row = static_cast<int>(cell / grid.columns);
  const Vec3 at(points.positions[grid.lowest[cell]]);
  const auto around = [&](int reach, auto&& visit) {
    for (int r = std::max(0, row - reach); r <= std::min(rows - 1, row + reach); ++r)
      for (int c = std::max(0, column - reach); c <= std::min(columns - 1, column + reach); ++c) {
        const std::size_t other = static_cast<std::size_t>(r) * grid.columns + static_cast<std::size_t>(c);
        if (other != cell && grid.lowest[other] != GroundGrid::kNone)
          visit(Vec3(points.positions[grid.lowest[other]]) - at);
      }
  };
  bool least = true;
  double above = 0;
  int neighbours = 0;
  around(1, [&](const Vec3& p) { least = least && p.z >= 0, above += p.z, ++neighbours; });
  // A cheap test first.
  if (!least || above < kLeastMeanDepth * grid.cell * neighbours) return false;
  PlaneSums sums;
  around(kStrayReach, [&](const Vec3& p) { sums.add(p.x, p.y, p.z, 1); });
  if (sums.w < kStrayMajority) return false;
  const PlaneSums::Central c = sums.central();
  if (!(c.determinant > 0)) return false;
  const LocalPlane plane = sums.plane(c);
  std::size_t as_low = 0;
  around(kStrayReach,
         [&](const Vec3& p) { as_low += p.z - plane.rise_x * p.x - plane.rise_y * p.y < kStrayDepth * grid.cell; });
  return kStrayMajority * as_low <= static_cast<std::size_t>(sums.w);
}

/// Removes stray samples below the ground: a cell loses one sample a round, and clusters one cell a round.
void remove_strays(const PointSet& points, GroundGrid& grid) {
  constexpr int kRounds = 4;
  constexpr auto kChangeReach = static_cast<std::size_t>(kStrayReach);
  // 1: a sample of the neighbourhood has changed since the last round.
  std::vector<std::uint8_t> changed(grid.size(), 1), stray(grid.size(), 0);
  for (int round = 0; round < kRounds; ++round) {
    parallel_for(0, grid.size(), 4096, [&](std::size_t i) {
      stray[i] = changed[i] && grid.lowest[i] != GroundGrid::kNone && is_stray(points, grid, i);
    });
    std::fill(changed.begin(), changed.end(), std::uint8_t{0});
    bool any = false;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!stray[i]) continue;
      grid.cell_of[grid.lowest[i]] = GroundGrid::kNone, any = true;
      const std::size_t row = i / grid.columns, column = i % grid.columns;
      for (std::size_t r = row - std::min(row, kChangeReach); r <= std::min(grid.rows - 1, row + kChangeReach); ++r)
        for (std::size_t c = column - std::min(column, kChangeReach);
             c <= std::min(grid.columns - 1, column + kChangeReach); ++c)
          changed[r * grid.columns + c] = 1;
    }
    if (!any) return;
    find_lowest(points, grid);
  }
}

}  // namespace

std::optional<SurveyExtent> measure_survey(const PointSet& points) {
  std::vector<float> x, y;
  const std::size_t step = 1 + points.size() / kExtentSamples;
  for (std::size_t i = 0; i < points.size(); i += step)
    if (is_finite(points.positions[i])) x.push_back(points.positions[i].x), y.push_back(points.positions[i].y);
  if (x.size() < 3) return std::nullopt;
  const auto range = [](std::vector<float>& values) {
    const auto cut = static_cast<std::size_t>(kFarShare * static_cast<double>(values.size()));
    const auto lower = static_cast<double>(nth_smallest(values, cut));
    const auto upper = static_cast<double>(nth_smallest(values, values.size() - 1 - cut));
    return std::array{lower - kFarMargin * (upper - lower), upper + kFarMargin * (upper - lower)};
  };
  const auto wide = range(x), deep = range(y);
  SurveyExtent limits{{wide[0], deep[0], 0}, {wide[1], deep[1], 0}};
  Box3f box;
  std::size_t n = 0;
  for (const Vec3f& p : points.positions)
    if (in_extent(p, limits)) box.extend(p), ++n;
  SurveyExtent extent{Vec3(box.lower), Vec3(box.upper)};
  const double width = extent.upper.x - extent.lower.x, depth = extent.upper.y - extent.lower.y;
  if (n < 3 || !(std::min(width, depth) > kLeastSide * std::max(width, depth))) return std::nullopt;
  double area = width * depth;
  for (int round = 0; round < 2; ++round) area = covered_area(points, extent, area, static_cast<double>(n));
  extent.spacing = std::sqrt(area / static_cast<double>(n));
  return extent;
}

GroundGrid make_ground_grid(const PointSet& points, const SurveyExtent& extent, double cell, double shift,
                            const GroundGrid* without) {
  GroundGrid grid;
  const double width = extent.upper.x - extent.lower.x, depth = extent.upper.y - extent.lower.y;
  grid.cell = std::max(cell, least_cell(width, depth, static_cast<double>(points.size())));
  grid.left = extent.lower.x - shift * grid.cell, grid.bottom = extent.lower.y - shift * grid.cell;
  grid.columns = whole_part<std::size_t>(width / grid.cell + shift) + 1;
  grid.rows = whole_part<std::size_t>(depth / grid.cell + shift) + 1;
  grid.cell_of.assign(points.size(), GroundGrid::kNone);
  parallel_for(0, points.size(), 1 << 14, [&](std::size_t i) {
    const Vec3f& p = points.positions[i];
    if (!in_extent(p, extent) || (without && without->cell_of[i] == GroundGrid::kNone)) return;
    grid.cell_of[i] = static_cast<std::uint32_t>(
        index_of(static_cast<double>(p.y), grid.bottom, grid.cell, grid.rows) * grid.columns +
        index_of(static_cast<double>(p.x), grid.left, grid.cell, grid.columns));
  });
  find_lowest(points, grid);
  if (!without) remove_strays(points, grid);
  grid.inside.assign(grid.size(), 0);
  for (std::size_t r = 0; r < grid.rows; ++r)
    for (std::size_t c = 0; c < grid.columns; ++c) {
      if (grid.lowest[r * grid.columns + c] == GroundGrid::kNone) continue;
      for (std::size_t j = r < 2 ? 0 : r - 2; j <= std::min(grid.rows - 1, r + 2); ++j)
        for (std::size_t k = c < 2 ? 0 : c - 2; k <= std::min(grid.columns - 1, c + 2); ++k)
          grid.inside[j * grid.columns + k] = 1;
    }
  return grid;
}

}  // namespace sansmesh::inline v1
