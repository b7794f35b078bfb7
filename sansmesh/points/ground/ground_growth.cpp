#include "sansmesh/points/ground/ground_growth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/ground/local_plane.h"

namespace sansmesh::inline v1 {
namespace {

/// Radius of the neighbourhood (cells), and the least number of samples on a side.
constexpr std::ptrdiff_t kGrowthReach = 3;
constexpr int kFewestOnSide = 5;
/// Half planes: an octant with its successors.
constexpr std::size_t kOctants = 8, kOctantsOnSide = 4;
/// Distance (cells) at which the weight of a sample is a half, squared.
constexpr double kHalfWeight = 2;
/// Least determinant of the positions on a side, relative to that of uncorrelated ones.
constexpr double kLeastSpreadOnSide = 0.02;
/// Rounds of growth. Each adds up to kGrowthReach cells; a roof that touches a slope would be conquered from there.
constexpr int kGrowthRounds = 8;

/// Samples on a side.
struct Side {
  int count = 0;
  PlaneSums sums;

  void add(const Vec3& p, double weight) { ++count, sums.add(p.x, p.y, p.z, weight); }
  void add(const Side& o) { count += o.count, sums.add(o.sums); }

  /// Whether their plane passes the origin within the tolerance.
  bool passes_origin(const GroundTolerance& tolerance, double cell) const {
    if (count < kFewestOnSide) return false;
    const PlaneSums::Central c = sums.central();
    if (!(c.determinant > kLeastSpreadOnSide * c.xx * c.yy)) return false;
    const LocalPlane plane = sums.plane(c);
    const double rest = std::max(0.0, c.zz - plane.rise_x * c.xz - plane.rise_y * c.yz);
    const double variance = rest / sums.w * count / std::max(1, count - 3);
    return std::abs(plane.height) < tolerance.cells * cell + tolerance.deviations * std::sqrt(variance) +
                                        tolerance.slope * std::hypot(plane.rise_x, plane.rise_y);
  }
};

std::size_t octant_of(double x, double y) {
  const bool steep = std::abs(y) > std::abs(x);
  if (y >= 0) return x > 0 ? (steep ? 1 : 0) : (steep ? 2 : 3);
  return x <= 0 ? (steep ? 5 : 4) : (steep ? 6 : 7);
}

}  // namespace

bool continues_ground(const PointSet& points, const GroundGrid& grid, const std::vector<std::uint8_t>& ground,
                      std::size_t sample, const GroundTolerance& tolerance) {
  const auto columns = static_cast<std::ptrdiff_t>(grid.columns), rows = static_cast<std::ptrdiff_t>(grid.rows);
  const auto column = static_cast<std::ptrdiff_t>(grid.cell_of[sample]) % columns;
  const auto row = static_cast<std::ptrdiff_t>(grid.cell_of[sample]) / columns;
  const Vec3 at(points.positions[sample]);
  std::array<Side, kOctants> octants;
  int count = 0;
  for (std::ptrdiff_t j = -kGrowthReach; j <= kGrowthReach; ++j) {
    if (row + j < 0 || row + j >= rows) continue;
    for (std::ptrdiff_t k = -kGrowthReach; k <= kGrowthReach; ++k) {
      if (column + k < 0 || column + k >= columns || j * j + k * k > kGrowthReach * kGrowthReach + 1) continue;
      const auto cell = static_cast<std::size_t>((row + j) * columns + column + k);
      if (!ground[cell] || grid.lowest[cell] == sample) continue;
      const Vec3 p = Vec3(points.positions[grid.lowest[cell]]) - at;
      octants[octant_of(p.x, p.y)].add(p, 1 / (1 + (p.x * p.x + p.y * p.y) / (kHalfWeight * grid.cell * grid.cell)));
      ++count;
    }
  }
  if (count < kFewestOnSide) return false;
  for (std::size_t side = 0; side < kOctants; ++side) {
    Side all;
    for (std::size_t k = 0; k < kOctantsOnSide; ++k) all.add(octants[(side + k) % kOctants]);
    if (all.passes_origin(tolerance, grid.cell)) return true;
  }
  return false;
}

void grow_ground(const PointSet& points, const GroundGrid& grid, std::vector<std::uint8_t>& ground,
                 const GroundTolerance& tolerance) {
  // 1: the neighbourhood has changed since the last examination.
  std::vector<std::uint8_t> changed(grid.size(), 1), fresh(grid.size(), 0);
  for (int round = 0; round < kGrowthRounds; ++round) {
    parallel_for(0, grid.size(), 1024, [&](std::size_t i) {
      fresh[i] = grid.lowest[i] != GroundGrid::kNone && !ground[i] && changed[i] &&
                 continues_ground(points, grid, ground, grid.lowest[i], tolerance);
    });
    std::fill(changed.begin(), changed.end(), std::uint8_t{0});
    bool any = false;
    constexpr auto kReach = static_cast<std::size_t>(kGrowthReach);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!fresh[i]) continue;
      ground[i] = 1, any = true;
      const std::size_t r = i / grid.columns, c = i % grid.columns;
      for (std::size_t j = r < kReach ? 0 : r - kReach; j <= std::min(grid.rows - 1, r + kReach); ++j)
        for (std::size_t k = c < kReach ? 0 : c - kReach; k <= std::min(grid.columns - 1, c + kReach); ++k)
          changed[j * grid.columns + k] = 1;
    }
    if (!any) break;
  }
}

}  // namespace sansmesh::inline v1
