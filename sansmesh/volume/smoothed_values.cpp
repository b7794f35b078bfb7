#include "sansmesh/volume/smoothed_values.h"

#include <algorithm>
#include <utility>

#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume/samples/smooth_samples.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {

SmoothedValues smoothed_values(const SampledVolume& volume, VolumeValues values, std::optional<double> factor,
                               Progress& progress) {
  SmoothedValues result;
  result.values = std::move(values);
  if (factor && *factor == 0) return result;
  const std::vector<double> scales = value_scales(result.values);
  const VolumeValues scaled = scaled_values(result.values, scales);
  const std::vector<StarMetric> metrics = volume.lattice ? std::vector<StarMetric>() : star_metrics(volume);
  const SampleNoise noise = estimate_noise(volume, scaled, metrics, progress);
  result.smoothing = factor.value_or(noise.found ? 1 : 0);
  if (result.smoothing == 0) return result;
  const double unit = scales.empty() ? 1 : 1 / scales[0];
  const auto most = [&](const std::vector<double>& of) { return unit * *std::max_element(of.begin(), of.end()); };
  result.noise = most(noise.typical), result.least_noise = most(noise.least), result.most_noise = most(noise.most);
  SmoothedSamples smooth = smooth_samples(volume, scaled, metrics, noise, result.smoothing, progress);
  if (!scales.empty())
    for (double& v : smooth.values) v *= unit;
  result.values.values = std::move(smooth.values);
  result.deviations = std::move(smooth.deviations);
  for (float& d : result.deviations) d = static_cast<float>(static_cast<double>(d) * unit);
  return result;
}

}  // namespace sansmesh::inline v1
