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

constexpr std::size_t kRows = 5000;                          // examined rows of neighbours
constexpr std::size_t kParabolaNeighbours = 56;              // parabolas have that many
constexpr std::size_t kFewest = 40;                          // pairs of samples below which nothing can be said
constexpr double kMostPredicted = 3;                         // variance of a prediction, in variances of a sample
constexpr double kNoiseTails = 2.5, kWithoutTails = 0.9113;  // variance of a normal deviate without its tails
constexpr double kLikeNoise = 0.05, kAlternating = -0.35, kWave = 0.3, kSpreadOfPair = 0.6;
constexpr std::size_t kInRow = 3;         // samples of a row: two neighbours, and the next behind them
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

  /// Sets the residuals of all components; false without a reliable prediction.
  bool of(std::uint32_t sample, double* residuals) {
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
      residuals[m] = -rise * unit;
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

/// LeftOutResiduals of rows of three samples, in the order of samples.
struct Rows {
  std::size_t components = 1;
  std::vector<std::uint32_t> sample;  ///< kInRow per row
  std::vector<double> residual;       ///< all components of each
};

/// The neighbour of `middle` that is nearest to the continuation of the way from `first`.
std::uint32_t behind(const SampledVolume& volume, std::uint32_t first, std::uint32_t middle,
                     std::vector<std::uint32_t>& star) {
  const Vec3 at = volume.position(middle) + (volume.position(middle) - volume.position(first));
  volume.star(middle, star);
  return *std::min_element(star.begin(), star.end(), [&](std::uint32_t a, std::uint32_t b) {
    return squared_norm(volume.position(a) - at) < squared_norm(volume.position(b) - at);
  });
}

Rows look_at_rows(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                  Progress& progress) {
  const std::size_t n = volume.size(), c = values.components, count = std::min(n, kRows), width = kInRow * c;
  std::vector<std::array<std::uint32_t, kInRow>> chosen(count);
  std::vector<double> residual(count * width);
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
      const std::uint32_t next = star[k % star.size()];
      chosen[k] = {i, next, behind(volume, i, next, star)};
      if (chosen[k][2] == i) continue;
      known[k] = 1;
      for (std::size_t s = 0; s < kInRow && known[k]; ++s)
        known[k] = residuals.of(chosen[k][s], &residual[k * width + s * c]);
    }
    progress.advance(end - begin);
  });
  Rows rows;
  rows.components = c;
  for (std::size_t k = 0; k < count; ++k) {
    if (!known[k]) continue;
    rows.sample.insert(rows.sample.end(), chosen[k].begin(), chosen[k].end());
    const auto from = static_cast<std::ptrdiff_t>(k * width), to = static_cast<std::ptrdiff_t>((k + 1) * width);
    rows.residual.insert(rows.residual.end(), residual.begin() + from, residual.begin() + to);
  }
  return rows;
}

/// Mean of 2ab / (a² + b²) over residuals that differ from rounding and are no tails.
class SignCorrelation {
 public:
  void add(double a, double b, double deviation, double rounding) {
    const double square = a * a + b * b;
    if (!(square <= 2 * (kNoiseTails * deviation) * (kNoiseTails * deviation))) return;
    if (std::max(std::abs(a), std::abs(b)) <= rounding) return;
    sum_ += 2 * a * b / square, ++count_;
  }
  bool known() const { return count_ >= kFewest; }
  double mean() const { return sum_ / static_cast<double>(count_); }
  /// Whether independent residuals may have this correlation. Those of a fit without the sample are slightly opposite.
  bool like_noise() const {
    return mean() + kSpreadOfPair / std::sqrt(static_cast<double>(count_)) <= kLikeNoise && mean() >= kAlternating;
  }

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

/// Magnitudes of the residuals of a component without those of constant parts (masked, or outside the body).
std::vector<double> magnitudes_of(const Rows& rows, std::size_t m, double rounding) {
  std::vector<double> result;
  for (std::size_t i = m; i < rows.residual.size(); i += rows.components)
    if (const double r = std::abs(rows.residual[i]); r > rounding) result.push_back(r);
  return result;
}

}  // namespace

SampleNoise estimate_noise(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                           Progress& progress) {
  const std::size_t c = values.components;
  const Rows rows = look_at_rows(volume, values, metrics, progress);
  const double rounding = kRoundedToFloat * largest_value(values);
  SampleNoise noise;
  noise.typical.assign(c, 0.0);
  SignCorrelation next, beyond;  // neighbours; samples two steps apart
  bool above = false;
  for (std::size_t m = 0; m < c; ++m) {
    std::vector<double> magnitudes = magnitudes_of(rows, m, rounding);
    if (magnitudes.size() < 2 * kFewest) continue;
    const double s = deviation_of(std::move(magnitudes));
    noise.typical[m] = s;
    std::vector<double> own;
    own.reserve(rows.sample.size());
    for (const std::uint32_t i : rows.sample) own.push_back(values.values[i * c + m]);
    const double least = volume.in_cells && !volume.lattice ? kOfShapes * main_range(own) : 0;
    above = above || s > std::max(least, kQuanta * quantum_of(std::move(own)));
    for (std::size_t k = m; k < rows.residual.size(); k += kInRow * c) {
      const double* const r = &rows.residual[k];
      next.add(r[0], r[c], s, rounding), next.add(r[c], r[2 * c], s, rounding);
      beyond.add(r[0], r[2 * c], s, rounding);
    }
  }
  if (!next.known() || !beyond.known()) return noise;
  noise.correlation = next.mean();
  // Waves of three to four samples have independent neighbours, but alternate every two samples.
  noise.found = above && next.like_noise() && std::abs(beyond.mean()) <= kWave;
  return noise;
}

}  // namespace sansmesh::inline v1
