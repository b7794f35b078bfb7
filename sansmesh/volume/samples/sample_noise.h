// Noise of the samples of a volume.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/samples/noise_variation.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {

/// Standard deviations (unit of the array).
struct SampleNoise {
  bool found = false;           ///< whether the residuals are those of noise; otherwise all deviations are bounds
  std::vector<double> typical;  ///< per component, of the volume as a whole
  std::vector<NoiseByValue> by_value;  ///< per component: factors of the deviation
  NoiseByPlace by_place;               ///< further factors
  /// Distances in samples along the axes of a lattice from which on noise is independent (correlated_noise.h).
  std::array<std::size_t, 3> reach{1, 1, 1};
  double rician = 0;       ///< deviation of the parts of magnitudes (rician_noise.h); 0 for other noise
  double correlation = 0;  ///< mean of 2ab / (a² + b²) of residuals a, b of neighbours

  /// True if neighbouring samples share noise.
  bool correlated() const { return reach != std::array<std::size_t, 3>{1, 1, 1}; }
  /// "white", "correlated" or "Rician"; empty if none was found.
  const char* kind() const;
  bool varies() const;
  /// The deviation to report: of the component with most, or of the parts of magnitudes.
  double deviation() const;
  /// Deviation of a component where it has this value.
  double at(std::size_t component, double value, const Vec3& position) const {
    return typical[component] * by_value[component].at(value) * by_place.at(position);
  }
  /// The noise of the values times `factor`, which is positive.
  SampleNoise scaled(double factor) const;
};

/// Residuals of one component.
struct ComponentResiduals {
  std::vector<NoiseResidual> residuals;
  std::vector<ResidualPair> pairs;  ///< neighbours
};

/// Fits the factors by value, and on all components together those by place, to noise with `typical` deviations.
/// Residuals up to `rounding` do not count.
void find_variation(const std::vector<ComponentResiduals>& components, const Box3& box, double rounding,
                    SampleNoise& noise);

/// Largest residual that is rounding to floats.
inline double rounding_of(const VolumeValues& values) { return 2e-6 * largest_value(values); }

/// Estimates white noise from parabolas through the neighbours of some thousand samples, which leave the sample out:
/// residuals are divided by the deviation that noise of deviation 1 would give them, and their variance is taken
/// without the tails, to which steps belong (docs/methods/volume-noise.md). Noise may grow or fall with the value, and
/// vary slowly in space. Samples without a value of their own (`filled`) do not count.
///
/// Unresolved structure also leaves residuals, but those of neighbours have the same sign, whereas those of noise have
/// slightly opposite ones. So noise is found if the mean of 2ab / (a² + b²) over pairs of neighbours is between −0.35
/// and 0.05, and within ±0.3 two steps apart; values with a smallest difference (integers) need noise above 0.6 of it.
SampleNoise estimate_noise(const SampledVolume& volume, const VolumeValues& values, std::span<const StarMetric> metrics,
                           Progress& progress);

}  // namespace sansmesh::inline v1
