// One array of a volume prepared for reconstructions: real, finite everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

struct VolumeValues {
  std::string name;
  std::size_t components = 1;
  std::vector<double> values;  ///< all components of each sample
  /// Samples whose non-finite value was replaced, ring by ring, by the mean of known neighbours.
  std::vector<std::uint32_t> filled;

  std::span<const double> of(std::size_t sample) const {
    return std::span(values).subspan(sample * components, components);
  }
};

/// Message for a missing array that lists the available ones.
std::string no_array_named(const std::string& name, std::span<const std::string> available);

/// The array of that name. Throws ArgumentError that names the available arrays if there is none; DataError if no value
/// is finite, if values are so large that slopes between samples overflow (about 1e300), or if not all are 0 and all
/// are too small to be distinguished (below about 1e-300).
VolumeValues volume_values(const SampledVolume& volume, const std::string& name);

/// The largest absolute value of all components.
double largest_value(const VolumeValues& values);
/// Factors of the components for reconstructions: binary_scale() of the largest value of all. The same for all
/// components, whose squares are added: the weight of a component must not depend on the unit. Empty if the largest
/// value is moderate.
std::vector<double> value_scales(const VolumeValues& values);
/// The values multiplied by `scales`; unchanged if empty.
VolumeValues scaled_values(VolumeValues values, std::span<const double> scales);

}  // namespace sansmesh::inline v1
