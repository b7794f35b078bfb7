// Selects and weights the samples of a volume near a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/samples/sample_slopes.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// A sample with a weight.
struct WeightedSample {
  std::uint32_t sample;
  double weight;
  bool ball;  ///< the domain has a ball around it
  Vec3 gradient;
};

/// Samples near an isosurface. Writes slope, noise_distance and beta of the report.
std::vector<WeightedSample> isovalue_layer(const SampleSlopes& slopes, std::span<const double> values, double noise,
                                           const VolumeSurfaceOptions& options, VolumeSurfaceReport& report,
                                           Progress& progress);

/// Samples near borders of materials. Writes slope, noise_distance, beta and least_gradient of the report. Throws
/// DataError if all gradients vanish.
std::vector<WeightedSample> high_gradient_layer(const SampledVolume& volume, const SampleSlopes& slopes, double noise,
                                                const VolumeSurfaceOptions& options, VolumeSurfaceReport& report,
                                                Progress& progress);

}  // namespace sansmesh::inline v1
