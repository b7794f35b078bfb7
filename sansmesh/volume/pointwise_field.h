// What reconstructions that answer one point after the other have in common: where a point lies, what happens outside,
// threads, weighted sums of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/field/volume_field.h"
#include "sansmesh/volume/volume_locator.h"
#include "sansmesh/volume/volume_values.h"

namespace sansmesh::detail {

/// Outside of the volume values go on straight from the nearest place of it, by at most half of the local spacing.
class PointwiseField : public VolumeField {
 public:
  /// The values' rows are the samples of `volume`. Throws ArgumentError where they are not as many.
  PointwiseField(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

  Box3 bounds() const override { return bounds_; }
  std::size_t components() const override { return values_.components; }
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  /// The mean length of the edges of the cell.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;

 protected:
  /// The answer at x, a place of the volume: components() values, and as many gradients unless that is null. Returns
  /// the degree of the polynomials behind the answer.
  virtual std::uint8_t answer(const Vec3& x, const VolumePlace& place, double* values, Vec3* gradients) const = 0;

  const SampledVolume& volume() const { return *volume_; }
  const VolumeValues& samples() const { return values_; }

 private:
  template <class Visit>
  void for_each_place(std::span<const Vec3> x, const Visit& visit) const;

  std::shared_ptr<const SampledVolume> volume_;
  VolumeValues values_;
  Box3 bounds_;
  VolumeLocator locator_;
};

/// A sample's weight in a sum, and the gradient of the weight.
struct SampleWeight {
  std::uint32_t sample;
  double weight;
  Vec3 slope;
};

/// f(x) = Σ w_i(x) f_i.
class WeightedField : public PointwiseField {
 public:
  using PointwiseField::PointwiseField;

 protected:
  /// Replaces `out` by the weights at x, slopes where wanted.
  virtual void weights(const Vec3& x, const VolumePlace& place, bool slopes, std::vector<SampleWeight>& out) const = 0;
  std::uint8_t answer(const Vec3& x, const VolumePlace& place, double* values, Vec3* gradients) const final;
};

/// Where a coordinate lies among ascending knots (two or more): the number of the interval, the first or last one
/// beyond the ends.
std::size_t interval_of(std::span<const double> knots, bool uniform, double x);

}  // namespace sansmesh::detail
