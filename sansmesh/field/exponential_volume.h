// Volume field whose values are the exponentials of another field.
#pragma once

#include <memory>

#include "sansmesh/field/level_field.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// exp(g) for a field g of one component, the logarithm of a positive quantity. Values are positive everywhere. The
/// level set {exp(g) = v} is {g = log v}, with smaller differences of slope: users of level sets take logarithm().
class ExponentialVolume : public VolumeField, public LevelField {
 public:
  /// exp(g) · factor; a factor that is a power of two keeps all digits. Throws ArgumentError for several components.
  explicit ExponentialVolume(std::shared_ptr<const VolumeField> logarithm, double factor = 1);

  const std::shared_ptr<const VolumeField>& logarithm() const { return field_; }
  double factor() const { return factor_; }

  Box3 bounds() const override { return field_->bounds(); }
  std::size_t components() const override { return 1; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  /// With the function of the logarithm for its level set, if it has one.
  void evaluate_level(double level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override { field_->spacing(x, found); }
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  void exponentiate(const double* level, std::span<const Vec3> x, const VolumeFieldValues& wanted) const;

  std::shared_ptr<const VolumeField> field_;
  double factor_;
};

}  // namespace sansmesh::inline v1
