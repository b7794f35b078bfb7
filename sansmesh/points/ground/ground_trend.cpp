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
    std::vector<double> scratch;
    for (std::size_t c = 0; c < columns_; ++c) {
      const double x = (static_cast<double>(c) + 0.5) * square_, y = (static_cast<double>(r) + 0.5) * square_;
      std::array<PlaneValue, kMostSquares> values;
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
      planes_[r * columns_ + c] = fit_local_plane(std::span(values).first(count), grid.cell, scratch);
    }
  });
}

GroundTrend::At GroundTrend::at(double x, double y) const {
  const double dx = x - left_, dy = y - bottom_;
  const auto c = index_in<std::size_t>(dx / square_, 0, columns_ - 1);
  const auto r = index_in<std::size_t>(dy / square_, 0, rows_ - 1);
  const LocalPlane& p = planes_[r * columns_ + c];
  return {p.height + p.rise_x * (dx - (static_cast<double>(c) + 0.5) * square_) +
              p.rise_y * (dy - (static_cast<double>(r) + 0.5) * square_),
          std::hypot(p.rise_x, p.rise_y)};
}

}  // namespace sansmesh::inline v1
