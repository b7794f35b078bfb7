#include "sansmesh/partition/fit/level_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/fit/neighbour_walk.h"

namespace sansmesh::inline v1 {
namespace {

/// Noise above this share of a ball's radius is cut off by the ball; `uncut` then has to correct a quarter. Balls
/// stretched along the normal, to kNoiseHeight standard deviations, do not cut it off, but shapes that small are soon
/// unresolved.
constexpr double kMostNoise = 0.2, kMostTallNoise = 0.4;
/// Least number of samples of a fit for an estimate of the noise, in units of the freedom that it takes: with fewer,
/// the residual is not informative.
constexpr float kSpareFreedom = 1.5f;
constexpr double kKnownNoise = 0.3;  ///< least share of the samples around which the noise of a level must be known
constexpr std::size_t kLowestTenth = 10;

/// Residual variance of the samples about the surface, from the fits of a block and its neighbours; -1: unknown.
float pooled_noise(const std::vector<Trial>& trials, const SampleTree::Neighbours& around, int max_degree) {
  double sum = 0, n = 0;
  for (const std::int32_t k : around) {
    if (k < 0) continue;
    const Trial& o = trials[static_cast<std::size_t>(k)];
    // The highest degree with freedom left: its residual is noise, not shape.
    int d = o.highest;
    while (d > 1 && o.effective_count < kSpareFreedom * kFreedom[static_cast<std::size_t>(d)]) --d;
    if (d < std::min(2, max_degree) || o.reach != 1) continue;  // the residual of planes is also shape
    const double freedom = o.effective_count - kFreedom[static_cast<std::size_t>(d)];
    if (freedom < 1) continue;
    sum += o.residual(d) * o.effective_count;
    n += freedom;
  }
  return n > 0 ? static_cast<float>(sum / n) : -1;
}

}  // namespace

void pool_noise(const BlockFitter& fitter, ScaleChoice& choice) {
  const auto l = static_cast<std::size_t>(choice.finest);
  std::vector<Trial>& trials = choice.trials[l];
  parallel_ranges(0, trials.size(), 1024, [&](std::size_t first, std::size_t last) {
    NeighbourWalk walk(fitter.tree);
    for (std::size_t c = first; c < last; ++c) {
      walk.go(choice.finest, static_cast<std::uint32_t>(c));
      trials[c].noise = pooled_noise(trials, walk.own(), fitter.options.max_degree);
    }
  });
}

void spread_noise(const BlockFitter& fitter, ScaleChoice& choice) {
  for (int level = choice.finest - 1; level >= 0; --level) {
    const auto l = static_cast<std::size_t>(level);
    const auto& child = fitter.tree.level(level).child;
    const auto& begin = fitter.tree.level(level + 1).begin;
    const std::vector<Trial>& below = choice.trials[l + 1];
    parallel_for(0, choice.trials[l].size(), 1024, [&](std::size_t c) {
      double sum = 0, n = 0;
      for (std::uint32_t k = child[c]; k < child[c + 1]; ++k) {
        const double m = begin[k + 1] - begin[k];
        if (below[k].noise >= 0) sum += m * below[k].noise, n += m;
      }
      choice.trials[l][c].noise = n > 0 ? static_cast<float>(sum / n) : -1;
    });
  }
}

double find_noise(const BlockFitter& fitter, double samples, ScaleChoice& choice) {
  double evenness = 0;
  std::optional<int> level_of_estimate;  // the last one
  for (;; --choice.finest) {
    pool_noise(fitter, choice);
    const std::vector<Trial>& trials = choice.trials[static_cast<std::size_t>(choice.finest)];
    const auto& begin = fitter.tree.level(choice.finest).begin;
    std::vector<float> noises;
    double known = 0;
    for (std::size_t c = 0; c < trials.size(); ++c) {
      if (trials[c].noise < 0) continue;
      noises.push_back(trials[c].noise);
      known += begin[c + 1] - begin[c];
    }
    // If few blocks hold enough samples, those are not typical.
    if (known >= kKnownNoise * samples) {
      level_of_estimate = choice.finest;
      choice.variance = median(noises);
      const auto low = nth_smallest(noises, noises.size() / kLowestTenth);
      evenness = choice.variance > 0 ? std::sqrt(std::max(0.0f, low) / choice.variance) : 0;
      const double most = fitter.height > 0 ? kMostTallNoise : kMostNoise;
      if (std::sqrt(choice.variance) < most * fitter.fit_radius(choice.finest)) break;
    }
    if (choice.finest <= 2) {
      choice.finest = level_of_estimate.value_or(choice.finest);
      break;
    }
  }
  spread_noise(fitter, choice);
  return evenness;
}

}  // namespace sansmesh::inline v1
