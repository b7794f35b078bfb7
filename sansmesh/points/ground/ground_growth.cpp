#include "sansmesh/points/ground/ground_growth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/parallel.h"

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

/// Weighted sums for a plane.
struct SideSums {
  int count = 0;
  double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;

  void add(const Vec3& p, double weight) {
    ++count;
    w += weight, x += weight * p.x, y += weight * p.y, z += weight * p.z;
    xx += weight * p.x * p.x, xy += weight * p.x * p.y, yy += weight * p.y * p.y;
    xz += weight * p.x * p.z, yz += weight * p.y * p.z, zz += weight * p.z * p.z;
  }
  void add(const SideSums& o) {
    count += o.count;
    w += o.w, x += o.x, y += o.y, z += o.z, xx += o.xx, xy += o.xy, yy += o.yy, xz += o.xz, yz += o.yz, zz += o.zz;
  }

  /// Whether the plane passes the origin within the tolerance.
  bool passes_origin(const GroundTolerance& tolerance, double cell) const {
    if (count < kFewestOnSide) return false;
    const double cxx = xx - x * x / w, cxy = xy - x * y / w, cyy = yy - y * y / w;
    const double determinant = cxx * cyy - cxy * cxy;
    if (!(determinant > kLeastSpreadOnSide * cxx * cyy)) return false;
    const double cxz = xz - x * z / w, cyz = yz - y * z / w, czz = zz - z * z / w;
    const double a = (cxz * cyy - cyz * cxy) / determinant, b = (cyz * cxx - cxz * cxy) / determinant;
    const double height = (z - a * x - b * y) / w;
    const double variance = std::max(0.0, czz - a * cxz - b * cyz) / w * count / std::max(1, count - 3);
    return std::abs(height) <
           tolerance.cells * cell + tolerance.deviations * std::sqrt(variance) + tolerance.slope * std::hypot(a, b);
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
  std::array<SideSums, kOctants> octants;
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
    SideSums sums;
    for (std::size_t k = 0; k < kOctantsOnSide; ++k) sums.add(octants[(side + k) % kOctants]);
    if (sums.passes_origin(tolerance, grid.cell)) return true;
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
