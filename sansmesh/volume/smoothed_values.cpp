#include "sansmesh/volume/smoothed_values.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sansmesh/volume/samples/correlated_noise.h"
#include "sansmesh/volume/samples/rician_noise.h"
#include "sansmesh/volume/samples/smooth_samples.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMostUnasked = 4'000'000;

/// The layer of a lattice that repeats it, so that both copies of a sample do not count as two.
class SingleLayer {
 public:
  SingleLayer(const SampledVolume& volume, const VolumeValues& values) {
    if (!volume.lattice) return;
    const auto& axes = volume.lattice->axes;
    for (std::size_t k = 0; k < 3; ++k) size_[k] = axes[k].size();
    const std::array<std::size_t, 3> step{1, size_[0], size_[0] * size_[1]};
    std::array<bool, 3> copies{};
    for (std::size_t k = 0; k < 3; ++k) copies[k] = size_[k] == 2 && is_copied(values, step[k]);
    if (copies == std::array<bool, 3>{}) return;
    layer_.emplace();
    layer_->lattice = volume.lattice, layer_->in_cells = volume.in_cells;
    for (std::size_t k = 0; k < 3; ++k)
      if (copies[k]) layer_->lattice->axes[k].resize(1);
    values_.name = values.name, values_.components = values.components;
    for (std::size_t i = 0; i < volume.size(); ++i) {
      const std::size_t of = index_in_layer(i);
      if (of * values.components == values_.values.size()) {
        const auto own = values.of(i);
        values_.values.insert(values_.values.end(), own.begin(), own.end());
      }
    }
    for (const std::uint32_t i : values.filled)
      if (const std::size_t of = index_in_layer(i); values_.filled.empty() || values_.filled.back() < of)
        values_.filled.push_back(static_cast<std::uint32_t>(of));
  }

  const SampledVolume* volume() const { return layer_ ? &*layer_ : nullptr; }
  const VolumeValues& values() const { return values_; }

  /// Numbers of the layer's samples, repeated.
  template <class T>
  std::vector<T> repeated(const std::vector<T>& numbers) const {
    const std::size_t c = values_.components, n = size_[0] * size_[1] * size_[2];
    std::vector<T> result(n * c);
    for (std::size_t i = 0; i < n; ++i) std::copy_n(numbers.begin() + begin_of(i, c), c, result.begin() + at(i * c));
    return result;
  }

 private:
  static std::ptrdiff_t at(std::size_t i) { return static_cast<std::ptrdiff_t>(i); }
  std::ptrdiff_t begin_of(std::size_t sample, std::size_t c) const { return at(index_in_layer(sample) * c); }

  bool is_copied(const VolumeValues& values, std::size_t step) const {
    const std::size_t c = values.components, n = size_[0] * size_[1] * size_[2];
    for (std::size_t i = 0; i < n; ++i) {
      if (i / step % 2 != 0) continue;
      for (std::size_t m = 0; m < c; ++m)
        if (values.values[i * c + m] != values.values[(i + step) * c + m]) return false;
    }
    return true;
  }

  /// Samples of the first copies come first in each row of the numbering.
  std::size_t index_in_layer(std::size_t sample) const {
    std::size_t index = 0, step = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = sample % size_[k], size = layer_->lattice->axes[k].size();
      index += std::min(i, size - 1) * step;
      step *= size, sample /= size_[k];
    }
    return index;
  }

  std::array<std::size_t, 3> size_{};
  std::optional<SampledVolume> layer_;
  VolumeValues values_;
};

std::vector<StarMetric> metrics_of(const SampledVolume& volume) {
  return volume.lattice ? std::vector<StarMetric>() : star_metrics(volume);
}

SampleNoise estimate_any_noise(const SampledVolume& volume, const VolumeValues& values, Progress& progress) {
  const std::vector<StarMetric> metrics = metrics_of(volume);
  SampleNoise noise = estimate_noise(volume, values, metrics, progress);
  if (noise.found) noise.rician = rician_deviation(volume, values, metrics, noise);
  if (noise.found || !volume.lattice) return noise;
  SampleNoise correlated = estimate_correlated_noise(volume, values, progress);
  return correlated.found ? correlated : noise;
}

/// Samples `reach` apart, which have independent noise, are smoothed as volumes of their own.
SmoothedSamples smooth_apart(const SampledVolume& volume, const VolumeValues& values, const SampleNoise& noise,
                             double factor, Progress& progress) {
  if (!noise.correlated()) return smooth_samples(volume, values, metrics_of(volume), noise, factor, progress);
  const std::size_t c = values.components;
  const auto& axes = volume.lattice->axes;
  const auto& reach = noise.reach;
  SmoothedSamples result{values.values, std::vector<float>(values.values.size(), 0.0f)};
  for (std::size_t part = 0; part < reach[0] * reach[1] * reach[2]; ++part) {
    const std::array<std::size_t, 3> first{part % reach[0], part / reach[0] % reach[1], part / (reach[0] * reach[1])};
    SampledVolume sparse;
    sparse.lattice = volume.lattice, sparse.in_cells = volume.in_cells;
    for (std::size_t k = 0; k < 3; ++k) {
      sparse.lattice->axes[k].clear();
      for (std::size_t i = first[k]; i < axes[k].size(); i += reach[k]) sparse.lattice->axes[k].push_back(axes[k][i]);
    }
    const auto sample_of = [&](std::size_t i) {
      const auto at = sparse.lattice->indices(i);
      return first[0] + at[0] * reach[0] +
             axes[0].size() * (first[1] + at[1] * reach[1] + axes[1].size() * (first[2] + at[2] * reach[2]));
    };
    const std::size_t n = sparse.lattice->size();
    VolumeValues own;
    own.name = values.name, own.components = c;
    for (std::size_t i = 0; i < n; ++i) {
      const auto of = values.of(sample_of(i));
      own.values.insert(own.values.end(), of.begin(), of.end());
    }
    const SmoothedSamples smooth = smooth_samples(sparse, own, {}, noise, factor, progress);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t m = 0; m < c; ++m) {
        result.values[sample_of(i) * c + m] = smooth.values[i * c + m];
        result.deviations[sample_of(i) * c + m] = smooth.deviations[i * c + m];
      }
  }
  return result;
}

/// Means of magnitudes become signals.
void correct_magnitudes(double part, SmoothedValues& smoothed) {
  const auto signal = [&](double mean) { return part * signal_of_magnitude(mean / part); };
  for (std::size_t i = 0; i < smoothed.values.values.size(); ++i) {
    double& v = smoothed.values.values[i];
    float& deviation = smoothed.deviations[i];
    const auto d = static_cast<double>(deviation);
    deviation = static_cast<float>((signal(v + d) - signal(v - d)) / 2);
    v = signal(v);
  }
}

}  // namespace

bool smoothed_unasked(std::size_t samples) { return samples <= kMostUnasked; }

SampleNoise noise_of_values(const SampledVolume& volume, const VolumeValues& values, Progress& progress) {
  const SingleLayer layer(volume, values);
  if (layer.volume()) return noise_of_values(*layer.volume(), layer.values(), progress);
  const std::vector<double> scales = value_scales(values);
  if (scales.empty()) return estimate_any_noise(volume, values, progress);
  return estimate_any_noise(volume, scaled_values(values, scales), progress).scaled(1 / scales[0]);
}

SmoothedValues smoothed_values(const SampledVolume& volume, VolumeValues values, std::optional<double> factor,
                               Progress& progress, const SampleNoise* known) {
  SmoothedValues result;
  result.values = std::move(values);
  if (factor && *factor == 0) return result;
  const SampleNoise noise = known ? *known : noise_of_values(volume, result.values, progress);
  result.found = noise.found, result.kind = noise.kind();
  result.too_many = !factor && noise.found && !smoothed_unasked(volume.size());
  result.smoothing = factor.value_or(noise.found && !result.too_many ? 1 : 0);
  if (result.smoothing == 0 && !result.too_many) return result;
  result.noise = noise.deviation();
  if (result.too_many) return result;
  if (const SingleLayer layer(volume, result.values); layer.volume()) {
    const SmoothedValues smooth = smoothed_values(*layer.volume(), layer.values(), result.smoothing, progress, &noise);
    result.values.values = layer.repeated(smooth.values.values);
    result.deviations = layer.repeated(smooth.deviations);
    return result;
  }
  const std::vector<double> scales = value_scales(result.values);
  const double scale = scales.empty() ? 1 : scales[0], unit = 1 / scale;
  SmoothedSamples smooth =
      smooth_apart(volume, scaled_values(result.values, scales), noise.scaled(scale), result.smoothing, progress);
  if (!scales.empty())
    for (double& v : smooth.values) v *= unit;
  result.values.values = std::move(smooth.values);
  result.deviations = std::move(smooth.deviations);
  for (float& d : result.deviations) d = static_cast<float>(static_cast<double>(d) * unit);
  if (noise.rician > 0) correct_magnitudes(noise.rician, result);
  return result;
}

}  // namespace sansmesh::inline v1
