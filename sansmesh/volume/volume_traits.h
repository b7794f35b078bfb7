// What the values of a volume are like: resolved by their samples or not, noisy or not, with steps or without.
#pragma once

#include <array>
#include <cstddef>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/volume_values.h"

namespace sansmesh::inline v1 {

/// Told from some thousand samples: each is predicted from the samples around it by polynomials of degree 0 to 3. All
/// values are shares of the range that the array has (of vectors: of the largest range of a component).
struct VolumeTraits {
  std::size_t samples = 0;
  double range = 0;  ///< largest minus least value (unit of the array)
  /// Median error of predicting a sample from its neighbours, for each degree. It falls with the degree where samples
  /// are dense enough for what they show, and stays where there is noise, or structure between two samples.
  std::array<double, 4> left_out{};
  /// Root mean square of the same errors: what a few samples next to edges are missed by counts here.
  std::array<double, 4> left_out_rms{};
  double noise = 0;  ///< standard deviation of noise, if what no degree predicts is that: an upper bound
  /// Share of the samples next to steps: that are off by more than ten times the median, and a twentieth of the range.
  double steps = 0;

  /// Parabolas predict samples better than planes do: there is something to gain over linear interpolation.
  bool resolved() const { return left_out[2] < 0.8 * left_out[1] || left_out[1] < 1e-6; }
  /// They also do at the few samples that are predicted worst, which are those at edges.
  bool edges_resolved() const { return left_out_rms[2] < 0.5 * left_out_rms[1] || left_out_rms[1] < 1e-6; }
};

/// Deterministic, about a second at most. `values` are of the volume.
VolumeTraits measure_volume_traits(const SampledVolume& volume, const VolumeValues& values, Progress& progress);

}  // namespace sansmesh::inline v1
