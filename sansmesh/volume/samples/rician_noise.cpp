#include "sansmesh/volume/samples/rician_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/near_samples.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kPlaces = 4000, kAround = 27;
constexpr double kLeastRatio = 1.3, kMostRatio = 2.7;    // mean over deviation in 27 samples of background
constexpr double kLeastBackground = 0.03, kAlike = 0.5;  // share of places, and of those with similar deviation
constexpr double kSimilar = 0.4;                         // accepted differences of these
constexpr double kLeastSkewness = 0.42, kMostSkewness = 0.9;
/// Shares of magnitudes without signal below 0.5, 1 and 2 deviations of a part are 0.118, 0.393 and 0.865.
constexpr double kMostFromRayleigh = 0.05;
constexpr double kLeastStrong = 0.75, kMostStrong = 1.35;  // deviation at strong signals over that of a part
constexpr double kMostTabulated = 12;

/// exp(−|x|) I₀(x) and exp(−|x|) I₁(x), x >= 0: abramowitz1964, 9.8.1 to 9.8.4.
std::array<double, 2> scaled_bessel(double x) {
  const auto polynomial = [](double t, std::initializer_list<double> c) {
    double sum = 0;
    for (auto i = std::rbegin(c); i != std::rend(c); ++i) sum = sum * t + *i;
    return sum;
  };
  if (x < 3.75) {
    const double t = (x / 3.75) * (x / 3.75), e = std::exp(-x);
    return {e * polynomial(t, {1, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813}),
            e * x * polynomial(t, {0.5, 0.87890594, 0.51498869, 0.15084934, 0.02658733, 0.00301532, 0.00032411})};
  }
  const double t = 3.75 / x, unit = 1 / std::sqrt(x);
  return {unit * polynomial(t, {0.39894228, 0.01328592, 0.00225319, -0.00157565, 0.00916281, -0.02057706, 0.02635537,
                                -0.01647633, 0.00392377}),
          unit * polynomial(t, {0.39894228, -0.03988024, -0.00362018, 0.00163801, -0.01031555, 0.02282967, -0.02895312,
                                0.01787654, -0.00420059})};
}

/// Samples around a place that may be background.
struct Background {
  double mean = 0, deviation = 0, part = 0;  ///< `part`: deviation of a part, from the mean of squares
  double third = 0;                          ///< third central moment
  std::array<double, kAround> samples{};
};

std::vector<Background> look_at_places(const SampledVolume& volume, const VolumeValues& values,
                                       std::span<const StarMetric> metrics) {
  const std::size_t n = volume.size(), count = std::min(n, kPlaces);
  std::vector<Background> places(count);
  parallel_ranges(0, count, 64, [&](std::size_t begin, std::size_t end) {
    NearSamples near(volume, metrics);
    for (std::size_t k = begin; k < end; ++k) {
      const double shift = std::fmod(static_cast<double>(k) * 0.6180339887498949, 1.0);
      const double at = (static_cast<double>(k) + shift) * static_cast<double>(n) / static_cast<double>(count);
      near.gather(static_cast<std::uint32_t>(std::min(n - 1, static_cast<std::size_t>(at))), kAround);
      const auto samples = near.samples().first(std::min(kAround, near.samples().size()));
      const auto size = static_cast<double>(samples.size());
      if (samples.size() < kAround) continue;
      Background& b = places[k];
      for (std::size_t j = 0; j < kAround; ++j) b.samples[j] = values.values[samples[j]];
      double squares = 0;
      for (const std::uint32_t i : samples) b.mean += values.values[i] / size;
      for (const std::uint32_t i : samples) {
        const double d = values.values[i] - b.mean;
        squares += d * d, b.third += d * d * d * size / ((size - 1) * (size - 2));
      }
      b.deviation = std::sqrt(squares / (size - 1));
      b.part = std::sqrt((squares / size + b.mean * b.mean) / 2);
    }
  });
  return places;
}

/// Whether magnitudes at these places have the shares below some bounds that those without signal have.
bool are_rayleigh(const std::vector<Background>& places, double part) {
  for (const double bound : {0.5, 1.0, 2.0}) {
    std::ptrdiff_t below = 0;
    for (const Background& b : places)
      below += std::count_if(b.samples.begin(), b.samples.end(), [&](double v) { return v < bound * part; });
    const double share = static_cast<double>(below) / static_cast<double>(places.size() * kAround);
    if (std::abs(share - (1 - std::exp(-bound * bound / 2))) > kMostFromRayleigh) return false;
  }
  return true;
}

}  // namespace

double rician_deviation(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                        const SampleNoise& noise) {
  if (values.components != 1) return 0;
  if (std::any_of(values.values.begin(), values.values.end(), [](double v) { return v < 0; })) return 0;
  std::vector<Background> places = look_at_places(volume, values, metrics);
  const auto all = static_cast<double>(places.size());
  std::erase_if(places, [](const Background& b) {
    return !(b.mean >= kLeastRatio * b.deviation && b.mean <= kMostRatio * b.deviation && b.deviation > 0);
  });
  if (static_cast<double>(places.size()) < std::max(kLeastBackground * all, 40.0)) return 0;
  std::vector<double> parts;
  parts.reserve(places.size());
  for (const Background& b : places) parts.push_back(b.part);
  const double usual = median(parts), found = static_cast<double>(places.size());
  std::erase_if(places, [&](const Background& b) { return std::abs(b.part - usual) > kSimilar * usual; });
  if (static_cast<double>(places.size()) < kAlike * found) return 0;
  double squares = 0, variance = 0, third = 0;
  for (const Background& b : places)
    squares += b.part * b.part, variance += b.deviation * b.deviation, third += b.third;
  const auto count = static_cast<double>(places.size());
  const double part = std::sqrt(squares / count), skewness = third / count / std::pow(variance / count, 1.5);
  if (skewness < kLeastSkewness || skewness > kMostSkewness) return 0;
  if (!are_rayleigh(places, part)) return 0;
  std::vector<double> sorted = values.values;
  const double strong = nth_smallest(sorted, sorted.size() - 1 - sorted.size() / 50);
  const double there = noise.typical[0] * noise.by_value[0].at(strong) / part;
  return strong > 4 * part && there >= kLeastStrong && there <= kMostStrong ? part : 0;
}

double mean_magnitude(double signal) {
  if (signal > kMostTabulated) return std::sqrt(signal * signal + 1);
  const double half = signal * signal / 2;
  const auto [i0, i1] = scaled_bessel(half / 2);
  return std::sqrt(1.5707963267948966) * ((1 + half) * i0 + half * i1);
}

double signal_of_magnitude(double mean) {
  // The mean is smooth in the square of the signal, also at 0.
  constexpr std::size_t kSteps = 1440;
  static const std::vector<double> means = [] {
    std::vector<double> table(kSteps + 1);
    for (std::size_t i = 0; i <= kSteps; ++i)
      table[i] = mean_magnitude(kMostTabulated * std::sqrt(static_cast<double>(i) / kSteps));
    return table;
  }();
  if (!(mean > means.front())) return 0;
  if (mean >= means.back()) return std::sqrt(mean * mean - 1);
  const auto next = static_cast<std::size_t>(std::upper_bound(means.begin(), means.end(), mean) - means.begin());
  const double t = (mean - means[next - 1]) / (means[next] - means[next - 1]);
  return kMostTabulated * std::sqrt((static_cast<double>(next - 1) + t) / kSteps);
}

}  // namespace sansmesh::inline v1
