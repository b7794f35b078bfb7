// Smooth approximation where polynomials of cell means are not trusted.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/methods/grouped_field.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// Approximate moving least squares (make_amls_blend) with functions that reach over the star of a sample and two
/// iterations: smooth, and near the means without interpolating them. Samples count with the doubt of their polynomial.
class SmoothShare {
 public:
  /// values: means, or their logarithms; those at the centres follow from the polynomials of means. radii:
  /// supports of the polynomials, which the functions cover. Runs in parallel.
  SmoothShare(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeLocator> locator,
              VolumeValues values, bool logarithm, const LocalPolynomials& polynomials, std::vector<float> radii,
              Progress& progress);

  const GroupedField& field() const { return *field_; }
  /// 1 − trust, but for a hundredth.
  static float doubt_of(float trust);
  float doubt(std::size_t sample) const { return doubts_[sample]; }
  /// True if the polynomial of one of the samples is doubted.
  bool any(std::span<const std::uint32_t> samples) const;

 private:
  std::unique_ptr<GroupedField> field_;
  std::vector<float> doubts_;
};

}  // namespace sansmesh::inline v1
