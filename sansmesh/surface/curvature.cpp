#include "sansmesh/surface/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/surface/curvature_fit.h"

namespace sansmesh::inline v1 {
namespace {

using detail::CurvatureFitter, detail::kReachOverWidth, detail::same_sheet;

constexpr std::array<std::size_t, 11> kSizes{20, 28, 40, 56, 80, 112, 160, 224, 320, 448, 640};
constexpr std::size_t kTestedSamples = 400;
constexpr double kGoodEnough = 0.02;  ///< relative error of the curvatures that needs no larger neighbourhood

int choose_neighbours_on_tree(const KdTree& tree, const PointSet& points, double noise) {
  const std::size_t count = std::min(kTestedSamples, tree.size());
  constexpr std::size_t kCount = kSizes.size();
  // For each point and size, the variance due to noise and the squared change to the next size.
  constexpr double kNone = -1;
  std::vector<std::array<double, kCount>> variances(count), changes(count), squares(count);
  const CurvatureOptions options;
  parallel_ranges(0, count, 16, [&](std::size_t first, std::size_t last) {
    CurvatureFitter fitter(options);
    std::vector<Neighbour> found(kSizes.back());
    std::vector<double> distances;
    for (std::size_t p = first; p < last; ++p) {
      variances[p].fill(kNone);
      changes[p].fill(kNone);
      squares[p].fill(kNone);
      const std::uint32_t sample = tree.order()[p * tree.size() / count];
      const Vec3f x = points.positions[sample];
      const Vec3 normal = normalized(Vec3(points.normals[sample]));
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
  // Median over the points that have a value; kNone if there are none.
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
    // The bias grows with h², so in proportion to the size, by 0.4 from one size to the next: the change is 0.4 of
    // the bias, plus the effect of the noise, whose variance decreases by the difference of the two (the larger fit is
    // the better one); 0.7 of it in the median.
    shape = std::max(shape, std::max(0.0, change - 0.7 * (variance - next)) / 0.16);
    if (variance + shape < least) least = variance + shape, best = size;
    if (least < kGoodEnough * kGoodEnough * (typical(squares, size) - variance)) break;
  }
  return static_cast<int>(kSizes[best]);
}

}  // namespace

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
  if (options.bandwidth) return;
  neighbours_ = options.neighbours.value_or(0);
  if (neighbours_ == 0)
    neighbours_ = choose_neighbours_on_tree(tree_, points, options.noise ? *options.noise : estimate_noise(points));
}

void CurvatureEstimator::evaluate(std::span<const Vec3> x, std::span<const Vec3> normals,
                                  std::span<FittedCurvatures> result) const {
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
      if (options_.bandwidth) {
        radius = kReachOverWidth * *options_.bandwidth;
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

std::vector<FittedCurvatures> CurvatureEstimator::at_samples(Progress& progress) const {
  std::vector<FittedCurvatures> result(cloud_size_);
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
    if (options_.bandwidth) {
      std::vector<Neighbour> found;
      const double radius = kReachOverWidth * *options_.bandwidth;
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

std::vector<FittedCurvatures> estimate_curvatures(const PointSet& points, const CurvatureOptions& options,
                                                  Progress& progress) {
  return CurvatureEstimator(points, options).at_samples(progress);
}

}  // namespace sansmesh::inline v1
