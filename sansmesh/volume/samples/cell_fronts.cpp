#include "sansmesh/volume/samples/cell_fronts.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/cells/cell_adjacency.h"
#include "sansmesh/volume/samples/front_fit.h"
#include "sansmesh/volume/samples/sample_stencil.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kEnoughFrontCells = 27, kMostFrontCells = 60;
constexpr int kFrontRings = 3;
constexpr double kFrontWidth = 1.5;  ///< width of the weights exp(−‖u‖²/width²)
/// Trust of polynomials above which they need no front; below the first they may.
constexpr double kDoubtfulTrust = 0.3, kTrusted = 0.6;
/// Deviation of means from the fit, over the difference of the values: full trust up to the first, none from the
/// second.
constexpr double kSmallDeviation = 0.04, kLargeDeviation = 1.0 / 12;
/// Deviations of logarithms count more: exponentials are almost fronts.
constexpr double kOfLogarithms = 2;
/// The same over the deviation from a parabola through the means: a smooth rise between two flat regions is almost a
/// front, but a parabola explains it as well.
constexpr double kBetterThanParabola = 0.4, kLikeParabola = 0.7;
/// Distance of the front from the middle of its cell, in extents of the cell.
constexpr double kInsideCell = 0.75, kOutsideCell = 1.25;
/// Share of the stencil wholly on the smaller side of the front: a value from a few cells is uncertain.
constexpr double kSmallSide = 0.04, kLargeSide = 0.1;
/// Distance of a front from those of neighbours, in extents of the cell.
constexpr double kNearFronts = 0.1, kFarFronts = 0.25;
/// Sum of the trust of the neighbours with fronts: a front is a surface, not in one cell.
constexpr double kManyFronts = 2;
/// Least width of a front, in extents of its cell: less resolves no better.
constexpr double kLeastFrontWidth = 0.15;
/// Multiples of these limits from which another spread makes no front of a fit, which saves the fits of spreads.
constexpr double kHopeless = 2, kHopelessParabola = 1.3;
/// Width w of the step ½ (1 + tanh(s / w)) with the variance of two steps of half height at ± 1: √12 / π.
constexpr double kWidthOfSpread = 1.1026577908435842;

/// 1 up to `full`, 0 from `none`, smooth between.
double fade(double x, double full, double none) {
  const double t = std::clamp((none - x) / (none - full), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

class FrontFinder {
 public:
  FrontFinder(const SampledVolume& volume, const Adjacency& cells, const VolumeValues& values,
              const LocalPolynomials& polynomials, bool logarithm)
      : volume_(volume),
        cells_(cells),
        values_(values),
        polynomials_(polynomials),
        logarithm_(logarithm),
        stencil_(volume) {}

  /// The front of a sample; its trust is 0 if there is none.
  CellFront front_of(std::uint32_t i) {
    CellFront none;
    const double doubt = fade(static_cast<double>(polynomials_.trust[i]), kDoubtfulTrust, kTrusted);
    if (!(doubt > 0)) return none;
    const StarMetric metric = polynomials_.metric(volume_, i);
    stencil_.gather(i, metric, kEnoughFrontCells, kMostFrontCells, kFrontRings);
    top_ = bottom_ = values_.values[i];
    for (const std::uint32_t j : stencil_.samples())
      top_ = std::max(top_, values_.values[j]), bottom_ = std::min(bottom_, values_.values[j]);
    own_ = value_of(i);
    double farthest = 0;
    for (const std::uint32_t j : stencil_.samples()) farthest = std::max(farthest, std::abs(value_of(j) - own_));
    if (!(farthest > 0)) return none;
    scale_ = std::ldexp(1.0, std::ilogb(farthest));
    Vec3 normal;
    if (!normal_at(i, normal)) return none;
    take_cells(i);
    const double size = extent(i, normal);
    FrontShape shape;
    if (!(size > 0) || !fit_front(stencil_cells_, normal, size, shape)) return none;
    const double parabola = parabola_deviation(size);
    if (is_hopeless(shape, size, parabola) || !fit_spread(stencil_cells_, size, shape)) return none;
    return made(metric, shape, size, parabola, doubt);
  }

 private:
  double value_of(std::uint32_t sample) const {
    const double v = values_.values[sample];
    return logarithm_ ? std::exp(v - top_) : v;
  }
  /// The difference to the sample, so that a power of two scales all results exactly.
  double rise_of(std::uint32_t sample) const { return (value_of(sample) - own_) / scale_; }

  /// Direction of the least-squares gradient, in the metric, where it has the same spread along all axes.
  bool normal_at(std::uint32_t i, Vec3& normal) {
    const auto samples = stencil_.samples();
    const auto local = stencil_.local();
    Vec3 right;
    std::array<Vec3, 3> rows{};
    for (std::size_t s = 1; s < samples.size(); ++s) {
      const Vec3 u = local[s];
      const double w = std::exp(-squared_norm(u) / 2);
      right += u * (w * rise_of(samples[s]));
      for (std::size_t k = 0; k < 3; ++k) rows[k] += u * (w * u[k]);
    }
    const Vec3 slope = Matrix3{rows[0], rows[1], rows[2]}.solve(right);
    if (!is_finite(slope)) return false;
    const Vec3 g = polynomials_.metric(volume_, i).transposed(slope);
    const double length = norm(g);
    if (!(length > 0) || !std::isfinite(length)) return false;
    normal = g / length;
    return true;
  }

  /// Extent of the cells of a sample along a direction.
  double extent(std::uint32_t i, const Vec3& along) const {
    double least = 0, most = 0;
    bool first = true;
    for (const std::uint32_t cell : cells_[i])
      for (const std::uint32_t k : volume_.cells[cell]) {
        const double at = dot(volume_.corner(k) - volume_.positions[i], along);
        least = first ? at : std::min(least, at), most = first ? at : std::max(most, at);
        first = false;
      }
    return most - least;
  }

  void take_cells(std::uint32_t i) {
    const auto samples = stencil_.samples();
    const auto local = stencil_.local();
    const Vec3 origin = volume_.positions[i];
    stencil_cells_.cells.clear(), stencil_cells_.tetrahedra.clear();
    for (std::size_t s = 0; s < samples.size(); ++s) {
      FrontCells::Cell cell;
      cell.first = stencil_cells_.tetrahedra.size();
      for (const std::uint32_t c : cells_[samples[s]]) append_tetrahedra(c, origin);
      cell.last = stencil_cells_.tetrahedra.size();
      cell.center = volume_.positions[samples[s]] - origin;
      for (std::size_t t = cell.first; t < cell.last; ++t)
        for (const Vec3& x : stencil_cells_.tetrahedra[t]) cell.radius = std::max(cell.radius, norm(x - cell.center));
      cell.mean = rise_of(samples[s]);
      cell.weight = std::exp(-squared_norm(local[s]) / (kFrontWidth * kFrontWidth));
      stencil_cells_.cells.push_back(cell);
    }
  }

  void append_tetrahedra(std::uint32_t cell, const Vec3& origin) {
    using Corners = std::array<std::uint8_t, 4>;
    static constexpr Corners kTetrahedron[] = {{0, 1, 2, 3}};
    static constexpr Corners kPyramid[] = {{0, 1, 2, 4}, {0, 2, 3, 4}};
    static constexpr Corners kWedge[] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}};
    static constexpr Corners kHexahedron[] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                              {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
    static constexpr std::span<const Corners> kParts[] = {kTetrahedron, kPyramid, kWedge, kHexahedron};
    const auto corners = volume_.cells[cell];
    for (const Corners& part : kParts[static_cast<std::size_t>(volume_.cells.shapes[cell])]) {
      std::array<Vec3, 4> x;
      for (std::size_t k = 0; k < 4; ++k) x[k] = volume_.corner(corners[part[k]]) - origin;
      stencil_cells_.tetrahedra.push_back(x);
    }
  }

  /// Deviation of the logarithms of the means from those of the fit, over the difference of those of both sides: an
  /// exponential is no front.
  double logarithmic_deviation(const FrontShape& f, double size) const {
    double sum = 0, weights = 0;
    for (const FrontCells::Cell& cell : stencil_cells_.cells) {
      const double share = share_behind(stencil_cells_, cell, f, size);
      const double fitted = own_ + scale_ * (f.low + (f.high - f.low) * share), mean = own_ + scale_ * cell.mean;
      const double miss = std::log(mean / fitted);
      sum += cell.weight * miss * miss, weights += cell.weight;
    }
    const double rise = std::log((own_ + scale_ * f.high) / (own_ + scale_ * f.low));
    return std::sqrt(sum / weights) / rise;
  }

  /// Share of the weights of the cells that are nearly whole on one side of the front, on the side with fewer.
  double smaller_side(const FrontShape& f, double size) const {
    constexpr double kWhole = 0.1;
    double front = 0, behind = 0, weights = 0;
    for (const FrontCells::Cell& cell : stencil_cells_.cells) {
      const double share = share_behind(stencil_cells_, cell, f, size);
      front += cell.weight * std::max(1 - share / kWhole, 0.0);
      behind += cell.weight * std::max(1 - (1 - share) / kWhole, 0.0);
      weights += cell.weight;
    }
    return std::min(front, behind) / weights;
  }

  /// Root mean square of the means minus their least-squares parabola, which is a function of the centers: the second
  /// moments of cells of one size are about equal.
  double parabola_deviation(double size) const {
    using Row10 = Eigen::Matrix<double, 10, 1>;
    Eigen::Matrix<double, 10, 10> matrix = Eigen::Matrix<double, 10, 10>::Zero();
    Row10 right = Row10::Zero();
    double squares = 0, weights = 0;
    for (const FrontCells::Cell& cell : stencil_cells_.cells) {
      const Vec3 y = cell.center / size;
      Row10 row;
      row << 1, y.x, y.y, y.z, y.x * y.x, y.x * y.y, y.x * y.z, y.y * y.y, y.y * y.z, y.z * y.z;
      matrix += cell.weight * row * row.transpose();
      right += cell.weight * cell.mean * row;
      squares += cell.weight * cell.mean * cell.mean, weights += cell.weight;
    }
    matrix.diagonal() *= 1 + 1e-9;
    const Eigen::LDLT<Eigen::Matrix<double, 10, 10>> solver(matrix);
    const double explained = right.dot(solver.solve(right));
    return std::isfinite(explained) ? std::sqrt(std::max(squares - explained, 0.0) / weights)
                                    : std::sqrt(squares / weights);
  }

  bool is_hopeless(const FrontShape& f, double size, double parabola) const {
    return !(std::abs(f.offset) < kHopeless * kOutsideCell * size) ||
           !(f.deviation < kHopeless * kLargeDeviation * (f.high - f.low)) ||
           !(f.deviation < kHopelessParabola * kLikeParabola * parabola);
  }

  CellFront made(const StarMetric& metric, const FrontShape& f, double size, double parabola, double doubt) const {
    CellFront front;
    const double rise = f.high - f.low;
    const double low = own_ + scale_ * f.low, high = own_ + scale_ * f.high;
    if (logarithm_ && !(low > 0)) return front;
    double deviation = f.deviation / rise;
    if (logarithm_) deviation = std::max(deviation, kOfLogarithms * logarithmic_deviation(f, size));
    if (!(parabola > 0)) return front;
    const double trust = doubt * fade(-smaller_side(f, size), -kLargeSide, -kSmallSide) *
                         fade(deviation, kSmallDeviation, kLargeDeviation) *
                         fade(f.deviation, kBetterThanParabola * parabola, kLikeParabola * parabola) *
                         fade(std::abs(f.offset), kInsideCell * size, kOutsideCell * size);
    if (!(trust > 0.01)) return front;
    // From positions to the metric: x − x_i = Σ_k u_k r_k / ‖r_k‖².
    std::array<Vec3, 3> axes;
    for (std::size_t k = 0; k < 3; ++k) axes[k] = Vec3(metric.rows[k]) / squared_norm(Vec3(metric.rows[k]));
    const Vec3 linear = f.normal + f.tangent1 * f.slope1 + f.tangent2 * f.slope2;
    const double length = norm(linear);
    double matrix[3][3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = 0; l < 3; ++l) {
        const double k1 = dot(f.tangent1, axes[k]), k2 = dot(f.tangent2, axes[k]);
        const double l1 = dot(f.tangent1, axes[l]), l2 = dot(f.tangent2, axes[l]);
        matrix[k][l] = f.bend11 * k1 * l1 + f.bend12 * (k1 * l2 + k2 * l1) + f.bend22 * k2 * l2;
      }
    const double g[] = {dot(linear, axes[0]), dot(linear, axes[1]), dot(linear, axes[2]),
                        0.5 * matrix[0][0],   matrix[0][1],         matrix[0][2],
                        0.5 * matrix[1][1],   matrix[1][2],         0.5 * matrix[2][2]};
    for (std::size_t k = 0; k < front.g.size(); ++k) front.g[k] = static_cast<float>(g[k] / length);
    front.constant = static_cast<float>(-f.offset / length);
    const auto back = [&](double v) { return logarithm_ ? std::log(v) + top_ : v; };
    // Means do not leave the range of the values: shares of a phase stay within 0..1.
    front.low = std::max(back(low), bottom_), front.high = std::min(back(high), top_);
    front.width = static_cast<float>(std::max(f.spread * kWidthOfSpread, kLeastFrontWidth * size));
    front.size = static_cast<float>(size);
    front.trust = static_cast<float>(trust);
    return front;
  }

  const SampledVolume& volume_;
  const Adjacency& cells_;
  const VolumeValues& values_;
  const LocalPolynomials& polynomials_;
  bool logarithm_;
  double bottom_ = 0, top_ = 0;  // range of the stencil, of logarithms too
  double own_ = 0, scale_ = 1;   // value of the sample; unit of differences
  SampleStencil stencil_;
  FrontCells stencil_cells_;
};

double value_at(const CellFront& front, const Vec3& u) {
  const double m[] = {u.x, u.y, u.z, u.x * u.x, u.x * u.y, u.x * u.z, u.y * u.y, u.y * u.z, u.z * u.z};
  double sum = static_cast<double>(front.constant);
  for (std::size_t k = 0; k < front.g.size(); ++k) sum += static_cast<double>(front.g[k]) * m[k];
  return sum;
}

/// Reduces the trust of fronts that are far from those of their neighbours, seen from the point of each front next to
/// its sample.
void compare_fronts(const SampledVolume& volume, const LocalPolynomials& polynomials, CellFronts& found) {
  std::vector<float> trust(found.fronts.size());
  const std::size_t n = volume.size();
  parallel_ranges(0, n, 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (found.of[i] == CellFronts::kNone) continue;
      const CellFront& own = found.fronts[found.of[i]];
      const StarMetric metric = polynomials.metric(volume, i);
      const Vec3 normal = metric.transposed(
          {static_cast<double>(own.g[0]), static_cast<double>(own.g[1]), static_cast<double>(own.g[2])});
      const double slope2 = squared_norm(normal);
      const Vec3 foot = slope2 > 0 ? normal * (-static_cast<double>(own.constant) / slope2) : Vec3{};
      double sum = 0, weights = 0;
      for (const std::uint32_t j : volume.stars[i]) {
        if (found.of[j] == CellFronts::kNone) continue;
        const CellFront& other = found.fronts[found.of[j]];
        const Vec3 d = volume.positions[i] + foot - volume.positions[j];
        const double at = value_at(other, polynomials.metric(volume, j)(d)) / static_cast<double>(own.size);
        const double weight = static_cast<double>(other.trust);
        sum += weight * std::min(std::abs(at), 1.0), weights += weight;
      }
      const double apart = weights > 0 ? sum / weights : 1;
      trust[found.of[i]] =
          own.trust * static_cast<float>(fade(apart, kNearFronts, kFarFronts) * fade(-weights, -kManyFronts, 0));
    }
  });
  for (std::size_t k = 0; k < trust.size(); ++k) found.fronts[k].trust = trust[k];
}

}  // namespace

CellFronts find_cell_fronts(const SampledVolume& volume, const VolumeValues& values,
                            const LocalPolynomials& polynomials, bool logarithm) {
  CellFronts found;
  if (values.components != 1) return found;
  const std::size_t n = volume.size();
  const Adjacency cells = cells_of_samples(volume);
  constexpr std::size_t kChunk = 256;
  std::vector<std::vector<std::pair<std::uint32_t, CellFront>>> parts((n + kChunk - 1) / kChunk);
  parallel_ranges(0, parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    FrontFinder finder(volume, cells, values, polynomials, logarithm);
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t i = p * kChunk; i < std::min(n, (p + 1) * kChunk); ++i) {
        const CellFront front = finder.front_of(static_cast<std::uint32_t>(i));
        if (front.trust > 0) parts[p].emplace_back(static_cast<std::uint32_t>(i), front);
      }
  });
  for (const auto& part : parts)
    for (const auto& [sample, front] : part) {
      if (found.of.empty()) found.of.assign(n, CellFronts::kNone);
      found.of[sample] = static_cast<std::uint32_t>(found.fronts.size());
      found.fronts.push_back(front);
    }
  if (!found.fronts.empty()) compare_fronts(volume, polynomials, found);
  return found;
}

}  // namespace sansmesh::inline v1
