#include "sansmesh/surface/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/noise.h"

namespace sansmesh {
namespace {

using Weights = CurvatureOptions::Weights;

constexpr double kReachOverWidth = 1.6;  ///< neighbourhoods end at this many h: exp(−1.6²) = 0.08
constexpr std::array<std::size_t, 11> kSizes{20, 28, 40, 56, 80, 112, 160, 224, 320, 448, 640};
constexpr std::size_t kPlaces = 400;
constexpr double kGoodEnough = 0.02;  ///< relative error of the curvatures that no larger neighbourhood is asked for
constexpr std::size_t kUnknowns = 6;

/// Σ w row rowᵀ and Σ w row value, lower triangle only; the first `n` of the six unknowns take part.
struct NormalEquations {
  std::array<std::array<double, kUnknowns>, kUnknowns> a{};
  std::array<double, kUnknowns> right{};
  std::array<std::size_t, kUnknowns> active{};
  std::size_t n = 0;

  void add(const std::array<double, kUnknowns>& row, double w, double value) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      const double wr = w * row[i];
      for (std::size_t j = 0; j <= i; ++j) a[i][j] += wr * row[j];
      right[i] += wr * value;
    }
  }

  /// LDLᵀ in place; false if an unknown is (nearly) a combination of the others.
  bool factorise() {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t ai = active[i];
      const double before = a[ai][ai];
      for (std::size_t j = 0; j <= i; ++j) {
        const std::size_t aj = active[j];
        double s = a[ai][aj];
        for (std::size_t k = 0; k < j; ++k) s -= l_[i][k] * l_[j][k] * d_[k];
        if (j < i)
          l_[i][j] = s / d_[j];
        else
          d_[i] = s;
      }
      if (!(d_[i] > 1e-6 * before)) return false;
    }
    return true;
  }

  std::array<double, kUnknowns> solve(const std::array<double, kUnknowns>& b) const {
    std::array<double, kUnknowns> y{}, x{};
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = b[active[i]];
      for (std::size_t k = 0; k < i; ++k) y[i] -= l_[i][k] * y[k];
    }
    for (std::size_t i = n; i-- > 0;) {
      y[i] /= d_[i];
      for (std::size_t k = i + 1; k < n; ++k) y[i] -= l_[k][i] * y[k];
      x[active[i]] = y[i];
    }
    return x;
  }

 private:
  std::array<std::array<double, kUnknowns>, kUnknowns> l_{};
  std::array<double, kUnknowns> d_{};
};

/// One neighbourhood after another, without allocation in the loop. Lengths are divided by the radius of the
/// neighbourhood.
///
/// The equation of a neighbour, κ_i = χ₁ + χ₂ cos 2θ + χ₃ sin 2θ, times −‖d‖²/2 is one of heights z = ⟨n, d⟩:
/// z = −½(‖d‖² χ₁ + c χ₂ + s χ₃) [+ δ] [+ a u + b v], of weight w_i · 4/‖d‖⁴. An offset and slopes fit in there.
class CurvatureFitter {
 public:
  explicit CurvatureFitter(const CurvatureOptions& options) : options_(options) {}

  void start(const Vec3& normal) {
    normal_ = normal;
    tangent_frame(normal, t_, b_);
    offsets_.clear();
  }
  void add(const Vec3& offset) { offsets_.push_back({dot(offset, t_), dot(offset, b_), dot(offset, normal_)}); }

  /// Fits the first `count` offsets, all within `radius`.
  bool fit(std::size_t count, double radius) {
    radius_ = radius;
    equations_ = {};
    // χ first: they stay determined where the slopes are not.
    equations_.active = {0, 1, 2};
    equations_.n = 3;
    if (options_.offset) equations_.active[equations_.n++] = 3;
    if (options_.refit_normal) equations_.active[equations_.n++] = 4, equations_.active[equations_.n++] = 5;
    if (!(radius > 0)) return false;
    const double scale = 1 / radius;
    std::size_t used = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, kUnknowns> row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      equations_.add(row, weight, height);
      ++used;
    }
    if (used <= equations_.n || !equations_.factorise()) return false;
    solution_ = equations_.solve(equations_.right);
    return std::all_of(solution_.begin(), solution_.end(), [](double c) { return std::isfinite(c); });
  }

  /// χ₁, χ₂, χ₃ of the last fit.
  std::array<double, 3> chi() const { return {solution_[0] / radius_, solution_[1] / radius_, solution_[2] / radius_}; }

  /// Variance of χ₁ + that of χ₂ + that of χ₃, for heights of unit variance.
  double variance(std::size_t count) const {
    std::array<std::array<double, kUnknowns>, 3> inverse;
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, kUnknowns> unit{};
      unit[c] = 1;
      inverse[c] = equations_.solve(unit);
    }
    double sum = 0;
    const double scale = 1 / radius_;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, kUnknowns> row;
      double weight = 0, height = 0;
      if (!equation(offsets_[i] * scale, row, weight, height)) continue;
      for (const auto& line : inverse) {
        double influence = 0;
        for (std::size_t k = 0; k < kUnknowns; ++k) influence += line[k] * row[k];
        sum += influence * influence * weight * weight;
      }
    }
    return sum / (radius_ * radius_ * radius_ * radius_);
  }

  /// The fit is a quadric, the zero set of F = z + ½(χ₁‖d‖² + χ₂(u² − v²) + 2 χ₃ u v) − δ − a u − b v: its curvatures
  /// at the foot (0, 0, δ) are those of F's Hessian across the gradient.
  PrincipalCurvatures curvatures() const {
    const auto [c1, c2, c3, delta, a, b] = solution_;
    const Vec3 gradient{-a, -b, 1 + c1 * delta};
    const double length = norm(gradient);
    PrincipalCurvatures result;
    if (!(gradient.z > 0)) return result;
    const Vec3 n = gradient / length;
    Vec3 e, f;
    tangent_frame(n, e, f);
    const auto hessian = [&, c1 = c1, c2 = c2, c3 = c3](const Vec3& p, const Vec3& q) {
      return (c1 * dot(p, q) + c2 * (p.x * q.x - p.y * q.y) + c3 * (p.x * q.y + p.y * q.x)) / (length * radius_);
    };
    const double ee = hessian(e, e), ef = hessian(e, f), ff = hessian(f, f);
    const double mean = 0.5 * (ee + ff), half = 0.5 * (ee - ff), spread = std::hypot(half, ef);
    // The eigenvector to mean + spread, from the row without cancellation.
    Vec3 first = half >= 0 ? e * (spread + half) + f * ef : e * ef + f * (spread - half);
    first = spread > 0 ? normalized(first) : e;
    const Vec3 second = cross(n, first);
    const auto world = [&](const Vec3& p) { return Vec3f(t_ * p.x + b_ * p.y + normal_ * p.z); };
    result.k1 = static_cast<float>(mean + spread);
    result.k2 = static_cast<float>(mean - spread);
    result.direction1 = world(first);
    result.direction2 = world(second);
    result.normal = world(n);
    result.offset = static_cast<float>(delta * radius_);
    result.defined = true;
    return result;
  }

 private:
  /// The row, weight and height of one neighbour (lengths in radii); false for one without weight.
  bool equation(const Vec3& d, std::array<double, kUnknowns>& row, double& weight, double& height) const {
    const double flat = d.x * d.x + d.y * d.y, squared = flat + d.z * d.z;
    constexpr double kCoincident = 1e-10;
    if (!(flat > kCoincident)) return false;
    // With nothing but χ the equations are the source's: angles alone count. A quadric's are steadier where the offset
    // lets samples lie above or below the place.
    const double turn = options_.offset || options_.refit_normal ? 1 : squared / flat;
    row = {-0.5 * squared, -0.5 * turn * (d.x * d.x - d.y * d.y), -turn * d.x * d.y, 1, d.x, d.y};
    height = d.z;
    weight = 1 / (squared * squared);
    if (options_.weights == Weights::m_like)
      for (int k = 0; k < options_.tau; ++k) weight *= squared;
    if (options_.weights != Weights::uniform) weight *= std::exp(-kReachOverWidth * kReachOverWidth * squared);
    return true;
  }

  const CurvatureOptions& options_;
  Vec3 normal_, t_, b_;
  std::vector<Vec3> offsets_;
  NormalEquations equations_;
  std::array<double, kUnknowns> solution_{};
  double radius_ = 1;
};

/// Whether a neighbour may be a sample of the same sheet.
bool same_sheet(const Vec3& normal, const Vec3f& neighbours_normal) {
  return dot(normal, Vec3(neighbours_normal)) >= 0;
}

int choose_neighbours_on_tree(const KdTree& tree, const PointSet& points, double noise) {
  const std::size_t places = std::min(kPlaces, tree.size());
  constexpr std::size_t kCount = kSizes.size();
  // For each place and size the variance by the noise, and the squared change to the next size.
  constexpr double kNone = -1;
  std::vector<std::array<double, kCount>> variances(places), changes(places), squares(places);
  const CurvatureOptions options;
  parallel_ranges(0, places, 16, [&](std::size_t first, std::size_t last) {
    CurvatureFitter fitter(options);
    std::vector<Neighbour> found(kSizes.back());
    std::vector<double> distances;
    for (std::size_t p = first; p < last; ++p) {
      variances[p].fill(kNone);
      changes[p].fill(kNone);
      squares[p].fill(kNone);
      const std::uint32_t place = tree.order()[p * tree.size() / places];
      const Vec3f x = points.positions[place];
      const Vec3 normal = normalized(Vec3(points.normals[place]));
      if (!(squared_norm(normal) > 0)) continue;
      found.resize(kSizes.back());
      found.resize(tree.nearest(x, found));
      fitter.start(normal);
      distances.clear();
      std::array<double, 3> before{};
      bool has_before = false;
      std::size_t seen = 0, kept = 0;
      for (std::size_t size = 0; size < kCount && kSizes[size] <= found.size(); ++size) {
        for (; seen < kSizes[size]; ++seen) {
          const std::uint32_t i = found[seen].index;
          if (same_sheet(normal, points.normals[i])) fitter.add(Vec3(points.positions[i] - x)), ++kept;
        }
        if (!fitter.fit(kept, std::sqrt(static_cast<double>(found[seen - 1].squared_distance)))) {
          has_before = false;
          continue;
        }
        variances[p][size] = fitter.variance(kept) * noise * noise;
        const std::array<double, 3> chi = fitter.chi();
        squares[p][size] = chi[0] * chi[0] + chi[1] * chi[1] + chi[2] * chi[2];
        if (has_before) {
          double change = 0;
          for (std::size_t c = 0; c < 3; ++c) change += (chi[c] - before[c]) * (chi[c] - before[c]);
          changes[p][size - 1] = change;
        }
        before = chi;
        has_before = true;
      }
    }
  });

  std::vector<double> values;
  // The median over the places that have a value; kNone where none has.
  const auto typical = [&](const std::vector<std::array<double, kCount>>& all, std::size_t size) {
    values.clear();
    for (const auto& a : all)
      if (a[size] >= 0) values.push_back(a[size]);
    return values.empty() ? kNone : median(values);
  };
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  double shape = 0;
  for (std::size_t size = 0; size + 1 < kCount; ++size) {
    const double variance = typical(variances, size), next = typical(variances, size + 1);
    const double change = typical(changes, size);
    if (variance < 0 || next < 0 || change < 0) continue;
    // The bias grows with h², that is, in proportion to the size, by 0.4 from one size to the next: the change is 0.4
    // of the bias, plus what the noise does, whose variance falls by (the larger fit being the better one) the
    // difference of the two; 0.7 of it in the median.
    shape = std::max(shape, std::max(0.0, change - 0.7 * (variance - next)) / 0.16);
    if (variance + shape < least) least = variance + shape, best = size;
    if (least < kGoodEnough * kGoodEnough * (typical(squares, size) - variance)) break;
  }
  return static_cast<int>(kSizes[best]);
}

}  // namespace

float curvedness(const PrincipalCurvatures& c) { return std::sqrt(0.5f * (c.k1 * c.k1 + c.k2 * c.k2)); }

float shape_index(const PrincipalCurvatures& c) {
  return c.k1 == 0 && c.k2 == 0 ? 0 : 2 * std::numbers::inv_pi_v<float> * std::atan2(c.k1 + c.k2, c.k1 - c.k2);
}

void CurvatureOptions::validate() const {
  check_range("tau", tau, 1, 4);
  if (radius && !(*radius > 0 && std::isfinite(*radius))) throw ArgumentError("`radius` must be positive");
  if (neighbours) check_range("neighbours", *neighbours, 8, 2000);
  if (noise && !(*noise >= 0 && std::isfinite(*noise))) throw ArgumentError("`noise` must not be negative");
}

CurvatureEstimator::CurvatureEstimator(const PointSet& points, const CurvatureOptions& options)
    : options_(options), cloud_size_(points.size()) {
  options.validate();
  if (points.normals.size() != points.size()) throw DataError("curvatures need normals; the cloud has none");
  tree_ = KdTree(points.positions);
  positions_ = tree_.positions();
  normals_.resize(tree_.size());
  slot_of_.assign(points.size(), 0);
  parallel_for(0, tree_.size(), 4096, [&](std::size_t slot) {
    const std::uint32_t index = tree_.order()[slot];
    const Vec3f n = points.normals[index];
    normals_[slot] = is_finite(n) ? normalized(n) : Vec3f{};
    slot_of_[index] = static_cast<std::uint32_t>(slot);
  });
  if (options.radius) return;
  neighbours_ = options.neighbours.value_or(0);
  if (neighbours_ == 0)
    neighbours_ = choose_neighbours_on_tree(tree_, points, options.noise ? *options.noise : estimate_noise(points));
}

void CurvatureEstimator::evaluate(std::span<const Vec3> x, std::span<const Vec3> normals,
                                  std::span<PrincipalCurvatures> result) const {
  if (normals.size() != x.size() || result.size() != x.size())
    throw ArgumentError("CurvatureEstimator::evaluate: points, normals and results differ in number");
  parallel_ranges(0, x.size(), 256, [&](std::size_t first, std::size_t last) {
    CurvatureFitter fitter(options_);
    std::vector<Neighbour> found;
    for (std::size_t i = first; i < last; ++i) {
      result[i] = {};
      const Vec3 normal = normalized(normals[i]);
      if (!is_finite(x[i]) || !(squared_norm(normal) > 0)) continue;
      double radius = 0;
      if (options_.radius) {
        radius = kReachOverWidth * *options_.radius;
        tree_.within(Vec3f(x[i]), static_cast<float>(radius), found);
      } else {
        found.resize(static_cast<std::size_t>(neighbours_));
        found.resize(tree_.nearest(Vec3f(x[i]), found));
        if (!found.empty()) radius = std::sqrt(static_cast<double>(found.back().squared_distance));
      }
      if (found.empty() || static_cast<double>(found.front().squared_distance) > 0.25 * radius * radius) continue;
      fitter.start(normal);
      std::size_t count = 0;
      for (const Neighbour& neighbour : found) {
        const std::size_t slot = slot_of_[neighbour.index];
        if (same_sheet(normal, normals_[slot])) fitter.add(Vec3(positions_[slot]) - x[i]), ++count;
      }
      if (fitter.fit(count, radius)) result[i] = fitter.curvatures();
    }
  });
}

std::vector<PrincipalCurvatures> CurvatureEstimator::at_samples(Progress& progress) const {
  std::vector<PrincipalCurvatures> result(cloud_size_);
  progress.begin("curvatures", tree_.size());
  constexpr std::size_t kSlots = 2048;
  parallel_ranges(0, tree_.size(), kSlots, [&](std::size_t first, std::size_t last) {
    CurvatureFitter fitter(options_);
    const auto fit = [&](std::size_t slot, std::span<const Neighbour> found, bool slots, double radius) {
      const Vec3 normal(normals_[slot]);
      if (squared_norm(normal) == 0) return;
      fitter.start(normal);
      std::size_t count = 0;
      for (const Neighbour& neighbour : found) {
        const std::size_t s = slots ? neighbour.index : slot_of_[neighbour.index];
        if (same_sheet(normal, normals_[s])) fitter.add(Vec3(positions_[s] - positions_[slot])), ++count;
      }
      if (fitter.fit(count, radius)) result[tree_.order()[slot]] = fitter.curvatures();
    };
    if (options_.radius) {
      std::vector<Neighbour> found;
      const double radius = kReachOverWidth * *options_.radius;
      for (std::size_t slot = first; slot < last; ++slot) {
        tree_.within(positions_[slot], static_cast<float>(radius), found);
        fit(slot, found, false, radius);
      }
    } else {
      tree_.for_each_nearest(static_cast<std::size_t>(neighbours_), first, last,
                             [&](std::uint32_t slot, std::span<const Neighbour> found) {
                               if (found.empty()) return;
                               fit(slot, found, true, std::sqrt(static_cast<double>(found.back().squared_distance)));
                             });
    }
    progress.advance(last - first);
  });
  progress.finish();
  return result;
}

int choose_curvature_neighbours(const PointSet& points, double noise) {
  if (points.normals.size() != points.size()) throw DataError("curvatures need normals; the cloud has none");
  return choose_neighbours_on_tree(KdTree(points.positions), points, noise);
}

std::vector<PrincipalCurvatures> estimate_curvatures(const PointSet& points, const CurvatureOptions& options,
                                                     Progress& progress) {
  return CurvatureEstimator(points, options).at_samples(progress);
}

}  // namespace sansmesh
