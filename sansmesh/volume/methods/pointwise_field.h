// What reconstructions that answer one point after the other have in common: where a point lies, what happens outside,
// threads, weighted sums of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1::detail {

/// What fields have that ask first in which cell a point lies: points in an order that suits the locator, cut into
/// batches for threads.
class LocatedField : public VolumeField {
 public:
  /// The values' rows are the samples of `volume`. Throws ArgumentError where they are not as many.
  LocatedField(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

  Box3 bounds() const override { return bounds_; }
  std::size_t components() const override { return values_.components; }
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  /// The mean length of the edges of the cell.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;

 protected:
  /// All that is wanted at x, point `i` of the batch, whose place is known.
  virtual void answer_at(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const = 0;

  /// Where the weights of a place are: x inside, the nearest place of the volume outside.
  Vec3 position_of(const VolumePlace& place) const;
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

/// Outside of the volume values go on straight from the nearest place of it, by at most half of the local spacing.
class PointwiseField : public LocatedField {
 public:
  using LocatedField::LocatedField;

 protected:
  /// The answer at x, a place of the volume: components() values, and as many gradients unless that is null.
  virtual void answer(const Vec3& x, const VolumePlace& place, double* values, Vec3* gradients) const = 0;
  void answer_at(std::size_t i, const Vec3& x, const VolumePlace& place, const VolumeAnswers& wanted) const final;
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
  void answer(const Vec3& x, const VolumePlace& place, double* values, Vec3* gradients) const final;
};

}  // namespace sansmesh::inline v1::detail
