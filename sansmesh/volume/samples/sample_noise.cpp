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

constexpr std::size_t kRows = 5000;              // examined rows of neighbours
constexpr std::size_t kParabolaNeighbours = 56;  // parabolas have that many
constexpr std::size_t kFewestResiduals = 80;     // fewer say nothing
constexpr double kMostPredicted = 3;             // variance of a prediction, in variances of a sample
constexpr double kWave = 0.3;                    // most correlation of noise two steps apart
constexpr std::size_t kInRow = 3;                // samples of a row: two neighbours, and the next behind them

/// Deviation over the range of the values below which unstructured cells may have no noise: means over cells of
/// different shapes differ from each other as noise does.
constexpr double kOfShapes = 0.005;

/// Values minus their predictions, over the deviation for noise of deviation 1.
class LeftOutResiduals {
 public:
  LeftOutResiduals(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                   const std::vector<std::uint8_t>& filled)
      : values_(values), filled_(filled), near_(volume, metrics) {}

  /// Sets the residuals of all components, and the predictions, NaN beside steps; false without a reliable prediction.
  bool of(std::uint32_t sample, double* residuals, double* predicted) {
    if (!filled_.empty() && filled_[sample] != 0) return false;
    near_.gather(sample, kParabolaNeighbours + 1);
    const auto u = near_.local();
    const double radius = near_.radius(kParabolaNeighbours + 1);
    weights_.assign(u.size(), 0.0);
    for (std::size_t j = 1; j < u.size(); ++j) weights_[j] = std::max(1 - near_.squares()[j] / (radius * radius), 0.0);
    if (!filled_.empty())
      for (std::size_t j = 1; j < u.size(); ++j)
        if (filled_[near_.samples()[j]] != 0) weights_[j] = 0;
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
      around_.clear();
      for (std::size_t j = 1; j < l.size(); ++j) {
        const double more = values_.values[near_.samples()[j] * c + m] - own;
        rise += l[j] * more;
        if (weights_[j] > 0) around_.push_back(more);
      }
      residuals[m] = -rise * unit;
      predicted[m] = are_two_groups(around_) ? std::numeric_limits<double>::quiet_NaN() : own + rise;
    }
    return true;
  }

 private:
  const VolumeValues& values_;
  const std::vector<std::uint8_t>& filled_;
  NearSamples near_;
  CentreFit fit_;
  std::vector<double> weights_, around_;
};

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
  std::vector<double> predicted;      ///< the same; NaN beside steps
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
  std::vector<double> residual(count * width), predicted(count * width);
  std::vector<std::uint8_t> filled(values.filled.empty() ? 0 : n, 0);
  for (const std::uint32_t i : values.filled) filled[i] = 1;
  std::vector<std::uint8_t> known(count, 0);
  progress.begin("look at noise", count);
  parallel_ranges(0, count, 64, [&](std::size_t begin, std::size_t end) {
    LeftOutResiduals residuals(volume, values, metrics, filled);
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
        known[k] = residuals.of(chosen[k][s], &residual[k * width + s * c], &predicted[k * width + s * c]);
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
    rows.predicted.insert(rows.predicted.end(), predicted.begin() + from, predicted.begin() + to);
  }
  return rows;
}

/// Magnitudes of the residuals of a component without those of constant parts (masked, or outside the body).
std::vector<double> magnitudes_of(const Rows& rows, std::size_t m, double rounding) {
  std::vector<double> result;
  for (std::size_t i = m; i < rows.residual.size(); i += rows.components)
    if (const double r = std::abs(rows.residual[i]); r > rounding) result.push_back(r);
  return result;
}

/// The residuals of each component, and which of them are neighbours.
std::vector<ComponentResiduals> by_component(const SampledVolume& volume, const Rows& rows) {
  std::vector<ComponentResiduals> components(rows.components);
  for (std::size_t m = 0; m < rows.components; ++m)
    for (std::size_t i = 0; i < rows.sample.size(); ++i) {
      const std::size_t at = i * rows.components + m;
      // Residuals beside steps say nothing about the noise.
      const double value = rows.predicted[at];
      components[m].residuals.push_back(
          {value, std::isnan(value) ? value : rows.residual[at], volume.position(rows.sample[i])});
      if (i % kInRow > 0)
        components[m].pairs.push_back({static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i)});
    }
  return components;
}

}  // namespace

const char* SampleNoise::kind() const {
  if (!found) return "";
  return rician > 0 ? "Rician" : correlated() ? "correlated" : "white";
}

bool SampleNoise::varies() const {
  return !by_place.empty() ||
         std::any_of(by_value.begin(), by_value.end(), [](const NoiseByValue& v) { return !v.empty(); });
}

double SampleNoise::deviation() const {
  return rician > 0 ? rician : *std::max_element(typical.begin(), typical.end());
}

SampleNoise SampleNoise::scaled(double factor) const {
  SampleNoise result = *this;
  for (double& t : result.typical) t *= factor;
  result.rician *= factor;
  for (NoiseByValue& curve : result.by_value)
    for (double& v : curve.values) v *= factor;
  return result;
}

void find_variation(const std::vector<ComponentResiduals>& components, const Box3& box, double rounding,
                    SampleNoise& noise) {
  std::vector<NoiseResidual> all;
  std::vector<ResidualPair> pairs;
  for (std::size_t m = 0; m < components.size(); ++m) {
    if (!(noise.typical[m] > 0)) continue;
    const ComponentResiduals& own = components[m];
    noise.by_value[m] = noise_by_value(own.residuals, own.pairs, noise.typical[m], rounding);
    const auto first = static_cast<std::uint32_t>(all.size());
    for (NoiseResidual r : own.residuals) {
      const double unit = noise.at(m, r.value, r.position);
      r.residual = std::abs(r.residual) > rounding ? r.residual / unit : std::numeric_limits<double>::quiet_NaN();
      all.push_back(r);
    }
    for (const ResidualPair& p : own.pairs) pairs.push_back({p.first + first, p.second + first});
  }
  noise.by_place = noise_by_place(all, pairs, box, 1, 0);
}

SampleNoise estimate_noise(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                           Progress& progress) {
  const std::size_t c = values.components;
  const Rows rows = look_at_rows(volume, values, metrics, progress);
  const double rounding = rounding_of(values);
  SampleNoise noise;
  noise.typical.assign(c, 0.0), noise.by_value.resize(c);
  SignCorrelation next, beyond;  // neighbours; samples two steps apart
  bool above = false;
  for (std::size_t m = 0; m < c; ++m) {
    std::vector<double> magnitudes = magnitudes_of(rows, m, rounding);
    if (magnitudes.size() < kFewestResiduals) continue;
    const double s = trimmed_deviation(std::move(magnitudes));
    noise.typical[m] = s;
    std::vector<double> own;
    own.reserve(rows.sample.size());
    for (const std::uint32_t i : rows.sample) own.push_back(values.values[i * c + m]);
    const double least = volume.in_cells && !volume.lattice ? kOfShapes * main_range(own) : 0;
    above = above || (s > least && is_above_rounding(s, std::move(own)));
    for (std::size_t k = m; k < rows.residual.size(); k += kInRow * c) {
      const double* const r = &rows.residual[k];
      next.add(r[0], r[c], s, rounding), next.add(r[c], r[2 * c], s, rounding);
      beyond.add(r[0], r[2 * c], s, rounding);
    }
  }
  find_variation(by_component(volume, rows), volume.bounds(), rounding, noise);
  if (!next.known() || !beyond.known()) return noise;
  noise.correlation = next.mean();
  // Waves of three to four samples have independent neighbours, but alternate every two samples.
  noise.found = above && next.like_noise() && std::abs(beyond.mean()) <= kWave;
  return noise;
}

}  // namespace sansmesh::inline v1
