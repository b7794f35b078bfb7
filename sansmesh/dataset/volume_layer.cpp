#include "sansmesh/dataset/volume_layer.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/parallel_collect.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Thickness of the layer: δ in ω = exp(−(d/δs)²), d the distance from the surface by value and slope, s the spacing.
/// The sum of Gaussians of this width is independent of the sample positions (Poisson summation: to 10⁻⁴); thicker
/// layers include more of the curvature of f.
constexpr double kThickness = 1;
constexpr std::size_t kLayerChunk = 65536;
/// Samples farther away are ignored: ω is below 0.01.
constexpr double kMostOff = 2.2;
/// Lower bound of the slope for the thickness of a layer, relative to the median: otherwise plateaus near the value
/// would count entirely.
constexpr double kLeastSlope = 0.05, kWeakSlope = 0.25;
/// Distance of samples with a ball over the thickness of the layer: any line through the layer enters a ball within
/// half a spacing of the surface.
constexpr double kBallsOff = 1.3;
constexpr double kSteepness = 0.35;    // β₂
constexpr double kLeastBorder = 0.15;  // relative to the largest gradient (without the top thousandth of the samples)
constexpr double kOutOfNoise = 4;      // times the median gradient
/// Shares of the local maximum above which a sample has a weight, and a ball.
constexpr double kCounts = 0.3, kOnRidge = 0.8;

/// Collects the samples found by chunks in order: the same for any number of threads.
template <class Choose>
std::vector<WeightedSample> choose_samples(std::size_t n, Progress& progress, const Choose& choose) {
  progress.begin("find the layer", n);
  const auto collect = [&](std::size_t first, std::size_t last, std::vector<WeightedSample>& found) {
    for (std::size_t i = first; i < last; ++i) choose(i, found);
    progress.advance(last - first);
  };
  return parallel_collect<WeightedSample>(n, kLayerChunk, collect);
}

/// Median slope of samples nearer to the value than to one of their neighbours; 0 if there are none.
double slope_at(const SampleSlopes& slopes, std::span<const double> values, double value) {
  constexpr std::size_t kMany = 200'000;
  const std::size_t stride = 1 + values.size() / (64 * kMany);
  const auto collect = [&](std::size_t first, std::size_t last, std::vector<double>& found) {
    for (std::size_t i = first; i < last; i += stride)
      if (std::abs(values[i] - value) < slopes.contrast(i)) found.push_back(norm(slopes.gradient(i)));
  };
  std::vector<double> found = parallel_collect<double>(values.size(), kLayerChunk, collect);
  return median(found);
}

}  // namespace

std::vector<WeightedSample> isovalue_layer(const SampleSlopes& slopes, std::span<const double> values, double noise,
                                           const VolumeSurfaceOptions& o, VolumeSurfaceReport& r, Progress& progress) {
  r.slope = slope_at(slopes, values, o.value);
  r.noise_distance = r.slope > 0 ? noise / r.slope : 0;
  r.beta = o.beta;
  return choose_samples(values.size(), progress, [&](std::size_t i, std::vector<WeightedSample>& found) {
    const double off = o.value - values[i];
    const double spacing = slopes.spacing(i);
    const double floor = kLeastSlope * r.slope * spacing + std::min(noise, kWeakSlope * r.slope * spacing);
    // The gradient is hardly larger than the contrast over the spacing: this rejects most samples.
    const double contrast = slopes.contrast(i);
    if (std::abs(off) > kMostOff * kThickness * (o.beta ? *o.beta : std::max(2 * contrast, floor))) return;
    const Vec3 gradient = slopes.gradient(i);
    const double steep = norm(gradient);
    if (!(steep > 0)) return;
    // For flat cells the thickness of the layer is the spacing across the surface.
    const double across = slopes.spacing_along(i, gradient / steep);
    const double beta = o.beta ? *o.beta : kThickness * std::max(steep * across, floor);
    const double away = std::abs(off) / beta;
    if (away > kMostOff) return;
    // On plateaus the level sets are far apart, and each sample represents little of their area.
    const double area = r.slope > 0 ? std::min(1.0, steep / (kWeakSlope * r.slope)) : 1;
    const double weight = std::exp(-away * away) * area * slopes.volume(i) / across;
    found.push_back({static_cast<std::uint32_t>(i), weight, away < kBallsOff, gradient});
  });
}

std::vector<WeightedSample> high_gradient_layer(const SampledVolume& volume, const SampleSlopes& slopes, double noise,
                                                const VolumeSurfaceOptions& o, VolumeSurfaceReport& r,
                                                Progress& progress) {
  const std::size_t n = volume.size();
  std::vector<float> steep(n);
  progress.begin("gradients");
  parallel_for(0, n, 4096, [&](std::size_t i) { steep[i] = static_cast<float>(norm(slopes.gradient(i))); });
  progress.check();
  std::vector<float> sorted = steep;
  const auto high = sorted.begin() + static_cast<std::ptrdiff_t>((n - 1) - n / 1000);
  std::nth_element(sorted.begin(), high, sorted.end());
  const double largest = static_cast<double>(*high);
  const double middle = static_cast<double>(median(sorted));
  r.least_gradient =
      o.least_gradient.value_or(std::max(kLeastBorder * largest, std::min(kOutOfNoise * middle, 0.5 * largest)));
  if (!(largest > 0) && !(middle > 0)) throw DataError("changes hardly anywhere: there is no border");
  const double beta = o.beta.value_or(kSteepness);
  r.beta = beta;
  std::vector<float> around;
  if (o.local_maximum) around = steepest_across(volume, slopes, steep, kCounts * r.least_gradient);
  std::vector<WeightedSample> all = choose_samples(n, progress, [&](std::size_t i, std::vector<WeightedSample>& found) {
    const double own = static_cast<double>(steep[i]), most = o.local_maximum ? static_cast<double>(around[i]) : largest;
    if (!(most > 0) || (o.local_maximum ? most : own) < r.least_gradient) return;
    const double share = std::min(1.0, own / most);
    if (o.local_maximum && share < kCounts) return;
    const double away = (share - 1) / beta;
    if (std::abs(away) > kMostOff) return;
    const Vec3 gradient = slopes.gradient(i);
    if (!(squared_norm(gradient) > 0)) return;
    const double across = slopes.spacing_along(i, normalized(gradient));
    const double weight = std::exp(-away * away) * slopes.volume(i) / across;
    const bool ball = o.local_maximum ? share > kOnRidge : std::abs(away) < kBallsOff;
    found.push_back({static_cast<std::uint32_t>(i), weight, ball, gradient});
  });
  std::vector<double> slope;
  for (const WeightedSample& c : all)
    if (c.ball) slope.push_back(norm(c.gradient));
  r.slope = median(slope);
  r.noise_distance = r.slope > 0 ? noise / r.slope : 0;
  return all;
}

}  // namespace sansmesh::inline v1
