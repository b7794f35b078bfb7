#include "sansmesh/volume/samples/front_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

constexpr int kParameters = 8;  // low, high, offset, two slopes, three curvatures
constexpr int kFrontSteps = 8;
/// Damping of slopes and curvatures, relative to their influence: those that the cells do not determine stay 0.
constexpr double kSlopeRidge = 1e-4, kBendRidge = 3e-3;
/// Starts of the offset, and spreads, in sizes of the cell.
constexpr double kFarthestStart = 1.25, kStartStep = 0.25;
constexpr std::array kSpreads{0.08, 0.2, 0.35, 0.55};

using Row = Eigen::Matrix<double, kParameters, 1>;
using Normal = Eigen::Matrix<double, kParameters, kParameters>;

/// Share of a cell behind the front, and its derivative by the offset of the front.
ShareBehind share_of(const FrontCells& cells, const FrontCells::Cell& cell, const FrontShape& f, double size) {
  // The tangent plane next to the centre of the cell, and the mean of the curvature beside it.
  const double y1 = dot(f.tangent1, cell.center), y2 = dot(f.tangent2, cell.center);
  const Vec3 slope = f.normal + f.tangent1 * (f.slope1 + f.bend11 * y1 + f.bend12 * y2) +
                     f.tangent2 * (f.slope2 + f.bend12 * y1 + f.bend22 * y2);
  const double bend = 0.5 * (f.bend11 * y1 * y1 + 2 * f.bend12 * y1 * y2 + f.bend22 * y2 * y2);
  const double base = -f.offset - bend + (f.bend11 + f.bend22) * size * size / 24;
  const double middle = base + dot(slope, cell.center), reach = norm(slope) * cell.radius + f.spread;
  if (middle >= reach) return {1, 0};
  if (middle <= -reach) return {0, 0};
  ShareBehind sum;
  double volume = 0;
  for (std::size_t t = cell.first; t < cell.last; ++t) {
    const auto& x = cells.tetrahedra[t];
    const double part = std::abs(dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])));
    volume += part;
    std::array<double, 4> g;
    for (std::size_t k = 0; k < 4; ++k) g[k] = base + dot(slope, x[k]);
    for (const double shift : {-f.spread, f.spread}) {
      const ShareBehind one = share_behind({g[0] + shift, g[1] + shift, g[2] + shift, g[3] + shift});
      sum.share += 0.5 * part * one.share, sum.slope += 0.5 * part * one.slope;
    }
  }
  if (volume > 0) sum.share /= volume, sum.slope /= volume;
  return sum;
}

/// Sum of squared deviations, with the best values of both sides for the shape.
double with_best_values(const FrontCells& cells, double size, FrontShape& f) {
  double s00 = 0, s01 = 0, s11 = 0, r0 = 0, r1 = 0, squares = 0;
  for (const auto& cell : cells.cells) {
    const double v = share_of(cells, cell, f, size).share, u = 1 - v, w = cell.weight;
    s00 += w * u * u, s01 += w * u * v, s11 += w * v * v, r0 += w * u * cell.mean, r1 += w * v * cell.mean;
    squares += w * cell.mean * cell.mean;
  }
  const double determinant = s00 * s11 - s01 * s01;
  if (!(determinant > 1e-6 * s00 * s11) || !(s00 > 0) || !(s11 > 0)) return std::numeric_limits<double>::infinity();
  f.low = (r0 * s11 - r1 * s01) / determinant;
  f.high = (r1 * s00 - r0 * s01) / determinant;
  return std::max(squares - f.low * r0 - f.high * r1, 0.0);
}

/// One step of Gauss and Newton. False if it is not determined.
bool improve(const FrontCells& cells, double size, FrontShape& f, double& error) {
  Normal matrix = Normal::Zero();
  Row right = Row::Zero();
  const double rise = f.high - f.low;
  for (const auto& cell : cells.cells) {
    const ShareBehind v = share_of(cells, cell, f, size);
    const double y1 = dot(f.tangent1, cell.center) / size, y2 = dot(f.tangent2, cell.center) / size;
    const double s = rise * v.slope * size;  // lengths in sizes
    Row row;
    row << 1 - v.share, v.share, -s, s * y1, s * y2, s * (0.5 * y1 * y1 + 1.0 / 24), s * y1 * y2,
        s * (0.5 * y2 * y2 + 1.0 / 24);
    const double miss = cell.mean - f.low - rise * v.share;
    matrix += cell.weight * row * row.transpose();
    right += cell.weight * miss * row;
  }
  const double influence = matrix(2, 2);
  if (!(influence > 0)) return false;
  const double parameters[] = {0, 0, 0, f.slope1, f.slope2, f.bend11 * size, f.bend12 * size, f.bend22 * size};
  for (int k = 3; k < kParameters; ++k) {
    const double ridge = influence * (k < 5 ? kSlopeRidge : kBendRidge);
    matrix(k, k) += ridge, right(k) -= ridge * parameters[k];
  }
  Eigen::LDLT<Normal> solver(matrix);
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return false;
  const Row step = solver.solve(right);
  if (!step.allFinite()) return false;
  double share = std::min(1.0, 0.5 / std::max(std::abs(step(2)), 1e-300));
  for (int k = 3; k < kParameters; ++k) share = std::min(share, 0.5 / std::max(std::abs(step(k)), 1e-300));
  for (int halving = 0; halving < 4; ++halving, share *= 0.5) {
    FrontShape next = f;
    next.offset += share * step(2) * size, next.slope1 += share * step(3), next.slope2 += share * step(4);
    next.bend11 += share * step(5) / size, next.bend12 += share * step(6) / size, next.bend22 += share * step(7) / size;
    const double found = with_best_values(cells, size, next);
    if (!(found < error)) continue;
    f = next, error = found;
    return true;
  }
  return false;
}

double settled(const FrontCells& cells, double size, FrontShape& f, int steps) {
  double error = with_best_values(cells, size, f);
  for (int step = 0; step < steps && std::isfinite(error); ++step) {
    const double before = error;
    if (!improve(cells, size, f, error) || error > before * (1 - 1e-4)) break;
  }
  return error;
}

/// Sets the deviation from the sum of squares. False if there is no front.
bool with_deviation(const FrontCells& cells, double squares, FrontShape& front) {
  if (!std::isfinite(squares) || !(front.high > front.low)) return false;
  double weight = 0;
  for (const auto& cell : cells.cells) weight += cell.weight;
  front.deviation = std::sqrt(squares / weight);
  return true;
}

}  // namespace

ShareBehind share_behind(std::array<double, 4> v) {
  if (v[0] > v[1]) std::swap(v[0], v[1]);
  if (v[2] > v[3]) std::swap(v[2], v[3]);
  if (v[0] > v[2]) std::swap(v[0], v[2]);
  if (v[1] > v[3]) std::swap(v[1], v[3]);
  if (v[1] > v[2]) std::swap(v[1], v[2]);
  if (v[3] <= 0) return {0, 0};
  if (v[0] >= 0) return {1, 0};
  // The three cases of the sorted values: one, two or three corners in front of the plane.
  if (v[2] <= 0) {
    const double scale = (v[3] - v[0]) * (v[3] - v[1]) * (v[3] - v[2]);
    return {v[3] * v[3] * v[3] / scale, 3 * v[3] * v[3] / scale};
  }
  if (v[1] >= 0) {
    const double scale = (v[1] - v[0]) * (v[2] - v[0]) * (v[3] - v[0]);
    return {1 + v[0] * v[0] * v[0] / scale, 3 * v[0] * v[0] / scale};
  }
  // Between: the density of the linear function's values is quadratic (a B-spline), so Simpson's rule is exact.
  const double scale = 3 / (v[3] - v[0]);
  const auto density = [&](double t) {
    return scale * ((t - v[0]) * (v[2] - t) / ((v[2] - v[0]) * (v[2] - v[1])) +
                    (v[3] - t) * (t - v[1]) / ((v[3] - v[1]) * (v[2] - v[1])));
  };
  const double above = (v[3] - v[2]) * (v[3] - v[2]) / ((v[3] - v[0]) * (v[3] - v[1]));
  const double slope = density(0);
  return {above + v[2] / 6 * (slope + 4 * density(v[2] / 2) + density(v[2])), slope};
}

double share_behind(const FrontCells& cells, const FrontCells::Cell& cell, const FrontShape& front, double size) {
  return share_of(cells, cell, front, size).share;
}

bool fit_front(const FrontCells& cells, const Vec3& normal, double size, FrontShape& front) {
  FrontShape start;
  start.normal = normal;
  const Vec3 aside = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  start.tangent1 = normalized(cross(normal, aside));
  start.tangent2 = cross(normal, start.tangent1);
  start.spread = kSpreads[1] * size;
  double best = std::numeric_limits<double>::infinity();
  for (double at = -kFarthestStart; at <= kFarthestStart; at += kStartStep) {
    FrontShape f = start;
    f.offset = at * size;
    const double error = with_best_values(cells, size, f);
    if (error < best && f.high > f.low) best = error, front = f;
  }
  if (!std::isfinite(best)) return false;
  best = settled(cells, size, front, kFrontSteps);
  return with_deviation(cells, best, front);
}

bool fit_spread(const FrontCells& cells, double size, FrontShape& front) {
  const FrontShape found = front;
  double best = with_best_values(cells, size, front);
  for (const double spread : kSpreads) {
    if (spread == kSpreads[1]) continue;
    FrontShape f = found;
    f.spread = spread * size;
    const double error = settled(cells, size, f, kFrontSteps / 2);
    if (error < best) best = error, front = f;
  }
  return with_deviation(cells, best, front);
}

}  // namespace sansmesh::inline v1
