#include "sansmesh/volume/smoothed_values.h"

#include <algorithm>
#include <utility>

#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume/samples/smooth_samples.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {
namespace {

/// Samples that are smoothed without being asked to: more take minutes.
constexpr std::size_t kMostUnasked = 4'000'000;

}  // namespace

SmoothedValues smoothed_values(const SampledVolume& volume, VolumeValues values, std::optional<double> factor,
                               Progress& progress) {
  SmoothedValues result;
  result.values = std::move(values);
  if (factor && *factor == 0) return result;
  const std::vector<double> scales = value_scales(result.values);
  const VolumeValues scaled = scaled_values(result.values, scales);
  const std::vector<StarMetric> metrics = volume.lattice ? std::vector<StarMetric>() : star_metrics(volume);
  const SampleNoise noise = estimate_noise(volume, scaled, metrics, progress);
  result.too_many = !factor && noise.found && volume.size() > kMostUnasked;
  result.smoothing = factor.value_or(noise.found && !result.too_many ? 1 : 0);
  if (result.smoothing == 0 && !result.too_many) return result;
  const double unit = scales.empty() ? 1 : 1 / scales[0];
  result.noise = unit * *std::max_element(noise.typical.begin(), noise.typical.end());
  if (result.too_many) return result;
  SmoothedSamples smooth = smooth_samples(volume, scaled, metrics, noise, result.smoothing, progress);
  if (!scales.empty())
    for (double& v : smooth.values) v *= unit;
  result.values.values = std::move(smooth.values);
  result.deviations = std::move(smooth.deviations);
  for (float& d : result.deviations) d = static_cast<float>(static_cast<double>(d) * unit);
  return result;
}

}  // namespace sansmesh::inline v1
