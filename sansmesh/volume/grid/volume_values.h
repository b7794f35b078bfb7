// One array of a volume, ready for reconstructions: reals, finite everywhere.
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
  std::vector<double> values;  ///< components a sample
  /// Samples whose value was not finite: it was filled in from the neighbours (ring by ring: the mean of those known).
  std::vector<std::uint32_t> filled;

  std::span<const double> of(std::size_t sample) const {
    return std::span(values).subspan(sample * components, components);
  }
};

/// The array of that name. Throws ArgumentError naming the arrays that there are where it is none of them, DataError
/// where not a single value is finite, values are so large that slopes between samples are no numbers any more (about
/// 1e300), or all are so small that they cannot be told apart (below about 1e-300, but for those that are all 0).
VolumeValues volume_values(const SampledVolume& volume, const std::string& name);

/// The largest value of all components, without its sign.
double largest_value(const VolumeValues& values);
/// By which each component is multiplied for reconstructions: binary_scale() of the largest value of all. It is the
/// same for all components, whose squares are added up: what weighs more in a vector must not depend on the unit. Empty
/// where the largest is of moderate size.
std::vector<double> value_scales(const VolumeValues& values);
/// The values times these; as they are where `scales` is empty.
VolumeValues scaled_values(VolumeValues values, std::span<const double> scales);

}  // namespace sansmesh::inline v1
