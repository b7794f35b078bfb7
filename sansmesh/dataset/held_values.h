// Values of a resampled volume within the bounds that its samples set.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/volume_locator.h"

namespace sansmesh::inline v1 {

/// Holds values of one component. Where values extrapolate, beyond the outermost samples in cells, they stay in the
/// range of the samples, gradually from the samples to the surface. If all samples are positive, values fall below the
/// least by at most 1 − ½ log₁₀(most/least) of the range: not at all from two decades on.
class HeldValues {
 public:
  /// `samples`: range of the samples. Safe from any thread.
  HeldValues(std::shared_ptr<const SampledVolume> volume, const ValueRange& samples);

  /// Changes the values at x, one per point.
  void hold(std::span<const Vec3> x, std::span<double> values) const;

 private:
  double beyond_in_lattice(const Vec3& x) const;

  std::shared_ptr<const SampledVolume> volume_;
  ValueRange samples_;
  double least_;                                  // bound of all values
  std::shared_ptr<const VolumeLocator> locator_;  // for samples in cells that are no lattice
  std::vector<std::uint8_t> outer_;               // per corner of their cells: on the surface
};

}  // namespace sansmesh::inline v1
