#include "sansmesh/volume/samples/sample_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/centre_fit.h"
#include "sansmesh/volume/samples/near_samples.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kPairs = 8000;                         // examined pairs of neighbours
constexpr std::size_t kParabolaNeighbours = 56;              // parabolas have that many
constexpr std::size_t kFewest = 40;                          // pairs below which nothing can be said
constexpr double kMostPredicted = 3;                         // variance of a prediction, in variances of a sample
constexpr double kNoiseTails = 2.5, kWithoutTails = 0.9113;  // variance of a normal deviate without its tails
constexpr double kLikeNoise = 0.05, kAlternating = -0.5, kSpreadOfPair = 0.6;
constexpr double kQuanta = 0.6;           // noise below is rounding to integers
constexpr double kRoundedToFloat = 2e-6;  // relative to the largest value: rounding to floats

/// Deviation over the range of the values below which unstructured cells may have no noise: means over cells of
/// different shapes differ from each other as noise does.
constexpr double kOfShapes = 0.005;

/// Values minus their predictions, over the deviation for noise of deviation 1.
class LeftOutResiduals {
 public:
  LeftOutResiduals(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics)
      : values_(values), near_(volume, metrics) {}

  /// Appends residuals and predictions of all components; false without a reliable prediction.
  bool of(std::uint32_t sample, double* residuals, double* predictions) {
    near_.gather(sample, kParabolaNeighbours + 1);
    const auto u = near_.local();
    const double radius = near_.radius(kParabolaNeighbours + 1);
    weights_.assign(u.size(), 0.0);
    for (std::size_t j = 1; j < u.size(); ++j) weights_[j] = std::max(1 - near_.squares()[j] / (radius * radius), 0.0);
    fit_.place(u);
    fit_.weigh(weights_);
    const auto l = fit_.coefficients(2);
    double variance = 0, sum = 0;
    for (const double c : l) variance += c * c, sum += c;
    if (!(variance > 0 && variance <= kMostPredicted && std::abs(sum - 1) < 1e-6)) return false;
    const double unit = 1 / std::sqrt(1 + variance);
    const std::size_t c = values_.components;
    for (std::size_t m = 0; m < c; ++m) {
      const double own = values_.values[sample * c + m];
      double rise = 0;
      for (std::size_t j = 1; j < l.size(); ++j) rise += l[j] * (values_.values[near_.samples()[j] * c + m] - own);
      residuals[m] = -rise * unit, predictions[m] = own + rise;
    }
    return true;
  }

 private:
  const VolumeValues& values_;
  NearSamples near_;
  CentreFit fit_;
  std::vector<double> weights_;
};

/// Deviation of normal deviates with other, larger numbers among them: the variance of those within 2.5 deviations.
double deviation_of(std::vector<double> magnitudes) {
  if (magnitudes.empty()) return 0;
  std::sort(magnitudes.begin(), magnitudes.end());
  std::vector<double> squares(magnitudes.size() + 1);
  for (std::size_t i = 0; i < magnitudes.size(); ++i) squares[i + 1] = squares[i] + magnitudes[i] * magnitudes[i];
  double s = kDeviationOverMedian * magnitudes[magnitudes.size() / 2];
  for (int again = 0; again < 50 && s > 0; ++again) {
    const auto n = static_cast<std::size_t>(std::upper_bound(magnitudes.begin(), magnitudes.end(), kNoiseTails * s) -
                                            magnitudes.begin());
    const double next = n > 0 ? std::sqrt(squares[n] / (static_cast<double>(n) * kWithoutTails)) : 0;
    if (std::abs(next - s) <= 1e-6 * s) return next;
    s = next;
  }
  return s;
}

/// The smallest difference of values of which all are multiples, as of integers; 0 if there is none.
double quantum_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 3) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) least = std::min(least, values[i] - values[i - 1]);
  const double steps = (values.back() - values.front()) / least;
  if (!(steps < 70000)) return 0;
  // Rounding of the least difference adds up over many steps.
  const double quantum = (values.back() - values.front()) / std::round(steps);
  for (const double v : values) {
    const double n = (v - values.front()) / quantum;
    if (std::abs(n - std::round(n)) > 0.02) return 0;
  }
  return quantum;
}

/// Difference of the hundredths from both ends.
double main_range(std::vector<double> values) {
  if (values.empty()) return 0;
  const std::size_t last = values.size() - 1;
  const double lower = nth_smallest(values, last / 100);
  return nth_smallest(values, last - last / 100) - lower;
}

/// LeftOutResiduals of pairs of neighbours, in the order of samples.
struct Pairs {
  std::size_t components = 1;
  std::vector<std::uint32_t> sample;         ///< two per pair
  std::vector<double> residual, prediction;  ///< all components of each
};

Pairs look_at_pairs(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                    Progress& progress) {
  const std::size_t n = volume.size(), c = values.components, count = std::min(n, kPairs);
  std::vector<std::array<std::uint32_t, 2>> chosen(count);
  std::vector<double> residual(count * 2 * c), prediction(count * 2 * c);
  std::vector<std::uint8_t> known(count, 0);
  progress.begin("look at noise", count);
  parallel_ranges(0, count, 64, [&](std::size_t begin, std::size_t end) {
    LeftOutResiduals residuals(volume, values, metrics);
    std::vector<std::uint32_t> star;
    for (std::size_t k = begin; k < end; ++k) {
      // Equal steps through a lattice would stay in few of its planes.
      const double shift = std::fmod(static_cast<double>(k) * 0.6180339887498949, 1.0);
      const auto i = static_cast<std::uint32_t>(
          std::min(n - 1, static_cast<std::size_t>((static_cast<double>(k) + shift) * static_cast<double>(n) /
                                                   static_cast<double>(count))));
      volume.star(i, star);
      if (star.empty()) continue;
      chosen[k] = {i, star[k % star.size()]};
      known[k] = residuals.of(chosen[k][0], &residual[2 * k * c], &prediction[2 * k * c]) &&
                 residuals.of(chosen[k][1], &residual[(2 * k + 1) * c], &prediction[(2 * k + 1) * c]);
    }
    progress.advance(end - begin);
  });
  Pairs pairs;
  pairs.components = c;
  for (std::size_t k = 0; k < count; ++k) {
    if (!known[k]) continue;
    pairs.sample.insert(pairs.sample.end(), chosen[k].begin(), chosen[k].end());
    const auto from = static_cast<std::ptrdiff_t>(2 * k * c), to = static_cast<std::ptrdiff_t>(2 * (k + 1) * c);
    pairs.residual.insert(pairs.residual.end(), residual.begin() + from, residual.begin() + to);
    pairs.prediction.insert(pairs.prediction.end(), prediction.begin() + from, prediction.begin() + to);
  }
  return pairs;
}

/// Magnitudes of the residuals of a component without those of constant parts (masked, or outside the body).
std::vector<double> magnitudes_of(const Pairs& pairs, std::size_t m, double rounding) {
  std::vector<double> result;
  for (std::size_t i = m; i < pairs.residual.size(); i += pairs.components)
    if (const double r = std::abs(pairs.residual[i]); r > rounding) result.push_back(r);
  return result;
}

}  // namespace

SampleNoise estimate_noise(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                           Progress& progress) {
  const std::size_t c = values.components;
  const Pairs pairs = look_at_pairs(volume, values, metrics, progress);
  const double rounding = kRoundedToFloat * largest_value(values);
  SampleNoise noise;
  noise.typical.assign(c, 0.0);
  double sum = 0;
  std::size_t count = 0;
  bool above = false;
  for (std::size_t m = 0; m < c; ++m) {
    std::vector<double> magnitudes = magnitudes_of(pairs, m, rounding);
    if (magnitudes.size() < 2 * kFewest) continue;
    const double s = deviation_of(std::move(magnitudes));
    noise.typical[m] = s;
    std::vector<double> own;
    for (const std::uint32_t i : pairs.sample) own.push_back(values.values[i * c + m]);
    const double least = volume.in_cells && !volume.lattice ? kOfShapes * main_range(own) : 0;
    above = above || s > std::max(least, kQuanta * quantum_of(std::move(own)));
    for (std::size_t k = m; k < pairs.residual.size(); k += 2 * c) {
      const double a = pairs.residual[k], b = pairs.residual[k + c], square = a * a + b * b;
      if (!(square <= 2 * (kNoiseTails * s) * (kNoiseTails * s)) || std::max(std::abs(a), std::abs(b)) <= rounding)
        continue;
      sum += 2 * a * b / square, ++count;
    }
  }
  if (count < kFewest) return noise;
  noise.correlation = sum / static_cast<double>(count);
  const double spread = kSpreadOfPair / std::sqrt(static_cast<double>(count));
  noise.found = above && noise.correlation + spread <= kLikeNoise && noise.correlation >= kAlternating;
  return noise;
}

}  // namespace sansmesh::inline v1
