#include "sansmesh/points/ground/ground_trend.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

/// Squares on each side of the one that a plane is fitted for.
constexpr std::size_t kReach = 2;
constexpr std::size_t kMostSquares = (2 * kReach + 1) * (2 * kReach + 1);
/// Least number of squares with ground, in two quadrants at least; otherwise squares of twice the size are used.
constexpr std::size_t kFewestSquares = 8;
constexpr int kFewestQuadrants = 2;
/// Rounds of reweighting, and the deviations from which values have no weight.
constexpr int kTrendRounds = 3;
constexpr double kTrendDeviations = 3;

/// Mean positions of the ground in squares.
struct SquareMeans {
  std::size_t columns = 0, rows = 0;
  double edge = 0;
  std::vector<std::array<float, 4>> means;  ///< x, y and z, and the number of cells

  SquareMeans doubled() const {
    SquareMeans d{(columns + 1) / 2, (rows + 1) / 2, 2 * edge, {}};
    d.means.assign(d.columns * d.rows, {});
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        const auto& from = means[r * columns + c];
        auto& to = d.means[r / 2 * d.columns + c / 2];
        for (std::size_t k = 0; k < 3; ++k) to[k] += from[3] * from[k];
        to[3] += from[3];
      }
    for (auto& m : d.means)
      for (std::size_t k = 0; k < 3 && m[3] > 0; ++k) m[k] /= m[3];
    return d;
  }
};

/// Position relative to the centre of the plane, with its weight.
struct TrendValue {
  double x, y, z, weight;
};

/// Weighted least squares with reweighting. Returns the height at 0 and the slopes.
std::array<double, 3> fit_trend_plane(std::span<const TrendValue> values, double cell) {
  std::array<double, 3> plane{};
  double scale = 0;
  std::vector<double> away;
  for (int round = 0; round < kTrendRounds; ++round) {
    double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const TrendValue& v : values) {
      const double e = v.z - plane[0] - plane[1] * v.x - plane[2] * v.y;
      const double weight = v.weight * (round > 0 ? tukey_weight(e / (kTrendDeviations * scale)) : 1);
      w += weight, x += weight * v.x, y += weight * v.y, z += weight * v.z;
      xx += weight * v.x * v.x, xy += weight * v.x * v.y, yy += weight * v.y * v.y;
      xz += weight * v.x * v.z, yz += weight * v.y * v.z;
    }
    if (!(w > 0)) break;
    // A slight ridge keeps slopes across a row of squares at 0.
    const double ridge = 1e-5 * (xx + yy - (x * x + y * y) / w) + 1e-12 * cell * cell;
    const double cxx = xx - x * x / w + ridge, cyy = yy - y * y / w + ridge, cxy = xy - x * y / w;
    const double cxz = xz - x * z / w, cyz = yz - y * z / w, determinant = cxx * cyy - cxy * cxy;
    const double a = (cxz * cyy - cyz * cxy) / determinant, b = (cyz * cxx - cxz * cxy) / determinant;
    plane = {(z - a * x - b * y) / w, a, b};
    away.clear();
    for (const TrendValue& v : values) away.push_back(std::abs(v.z - plane[0] - a * v.x - b * v.y));
    scale = kDeviationOverMedian * median(away) + 1e-3 * cell;
  }
  return plane;
}

}  // namespace

GroundTrend::GroundTrend(const PointSet& points, const GroundGrid& grid, const std::vector<std::uint8_t>& ground)
    : square_(2 * grid.cell), left_(grid.left), bottom_(grid.bottom) {
  std::vector<SquareMeans> levels(1);
  levels[0] = {grid.columns, grid.rows, grid.cell, {}};
  levels[0].means.assign(grid.size(), {});
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!ground[i]) continue;
    const Vec3 p(points.positions[grid.lowest[i]]);
    levels[0].means[i] = {static_cast<float>(p.x - left_), static_cast<float>(p.y - bottom_), static_cast<float>(p.z),
                          1};
  }
  levels[0] = levels[0].doubled();
  while (levels.back().columns > 2 || levels.back().rows > 2) levels.push_back(levels.back().doubled());
  columns_ = levels[0].columns, rows_ = levels[0].rows;
  planes_.resize(columns_ * rows_);
  parallel_for(0, rows_, 4, [&](std::size_t r) {
    for (std::size_t c = 0; c < columns_; ++c) {
      const double x = (static_cast<double>(c) + 0.5) * square_, y = (static_cast<double>(r) + 0.5) * square_;
      std::array<TrendValue, kMostSquares> values;
      std::size_t count = 0;
      for (std::size_t l = 0; l < levels.size(); ++l) {
        const SquareMeans& level = levels[l];
        const std::size_t at_c = c >> l, at_r = r >> l;
        const double reach = (static_cast<double>(kReach) + 0.75) * level.edge;
        unsigned quadrants = 0;
        count = 0;
        for (std::size_t j = at_r < kReach ? 0 : at_r - kReach; j <= std::min(level.rows - 1, at_r + kReach); ++j)
          for (std::size_t k = at_c < kReach ? 0 : at_c - kReach; k <= std::min(level.columns - 1, at_c + kReach);
               ++k) {
            const auto& m = level.means[j * level.columns + k];
            if (!(m[3] > 0)) continue;
            const double dx = static_cast<double>(m[0]) - x, dy = static_cast<double>(m[1]) - y;
            const double weight = tukey_weight(std::sqrt(dx * dx + dy * dy) / reach);
            if (!(weight > 0)) continue;
            values[count++] = {dx, dy, static_cast<double>(m[2]), weight};
            quadrants |= 1u << ((dx > 0 ? 1 : 0) + (dy > 0 ? 2 : 0));
          }
        if (count >= kFewestSquares && std::popcount(quadrants) >= kFewestQuadrants) break;
      }
      const auto plane = fit_trend_plane(std::span(values).first(count), grid.cell);
      planes_[r * columns_ + c] = {plane[0], plane[1], plane[2]};
    }
  });
}

GroundTrend::At GroundTrend::at(double x, double y) const {
  const double dx = x - left_, dy = y - bottom_;
  const auto c = index_in<std::size_t>(dx / square_, 0, columns_ - 1);
  const auto r = index_in<std::size_t>(dy / square_, 0, rows_ - 1);
  const Plane& p = planes_[r * columns_ + c];
  return {p.height + p.rise_x * (dx - (static_cast<double>(c) + 0.5) * square_) +
              p.rise_y * (dy - (static_cast<double>(r) + 0.5) * square_),
          std::hypot(p.rise_x, p.rise_y)};
}

}  // namespace sansmesh::inline v1
