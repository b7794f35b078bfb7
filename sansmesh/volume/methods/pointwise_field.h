// Base classes of reconstructions that evaluate point by point: point location, continuation outside, threads, weighted
// sums of samples.
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

/// Whether each list of results for n points is empty or has the right size.
inline bool sizes_agree(const VolumeFieldValues& wanted, std::size_t n, std::size_t components) {
  const auto fits = [](std::size_t size, std::size_t right) { return size == 0 || size == right; };
  return fits(wanted.values.size(), n * components) && fits(wanted.gradients.size(), n * components) &&
         fits(wanted.inside.size(), n);
}

/// Fields that first locate the cell of a point: orders the points for the locator and distributes batches over
/// threads.
class LocatedField : public VolumeField {
 public:
  /// The rows of `values` are the samples of `volume`. Throws ArgumentError if their numbers differ.
  LocatedField(std::shared_ptr<const SampledVolume> volume, VolumeValues values);

  Box3 bounds() const override { return bounds_; }
  std::size_t components() const override { return values_.components; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  /// Mean edge length of the cell.
  void spacing(std::span<const Vec3> x, std::span<double> found) const override;

 protected:
  /// Writes the requested results at x, point `i` of the batch, with known location.
  virtual void evaluate_point(std::size_t i, const Vec3& x, const CellLocation& location,
                              const VolumeFieldValues& wanted) const = 0;

  /// Position of the weights of a location: x inside, the nearest point of the volume outside.
  Vec3 position_of(const CellLocation& location) const;
  const SampledVolume& volume() const { return *volume_; }
  const VolumeValues& samples() const { return values_; }

 private:
  template <class Visit>
  void for_each_location(std::span<const Vec3> x, const Visit& visit) const;

  std::shared_ptr<const SampledVolume> volume_;
  VolumeValues values_;
  Box3 bounds_;
  VolumeLocator locator_;
};

/// Outside the volume values continue linearly from its nearest point, up to half of the local spacing.
class PointwiseField : public LocatedField {
 public:
  using LocatedField::LocatedField;

 protected:
  /// The result at x inside the volume: components() values, and as many gradients unless that is null.
  virtual void evaluate_at(const Vec3& x, const CellLocation& location, double* values, Vec3* gradients) const = 0;
  void evaluate_point(std::size_t i, const Vec3& x, const CellLocation& location,
                      const VolumeFieldValues& wanted) const final;
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
  /// Replaces `out` by the weights at x, with slopes if requested.
  virtual void weights(const Vec3& x, const CellLocation& location, bool slopes,
                       std::vector<SampleWeight>& out) const = 0;
  void evaluate_at(const Vec3& x, const CellLocation& location, double* values, Vec3* gradients) const final;
};

}  // namespace sansmesh::inline v1::detail
