// Volume field in another unit: rescales fields fitted to values of order 1.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Field times a factor per component. Powers of two keep all digits.
class ScaledVolume : public VolumeField {
 public:
  /// `factors`: one per component, positive. Throws ArgumentError for another number of factors.
  ScaledVolume(std::shared_ptr<const VolumeField> field, std::vector<double> factors);
  /// The same; a LevelField if `field` is one.
  static std::unique_ptr<VolumeField> of(std::shared_ptr<const VolumeField> field, std::vector<double> factors);
  Box3 bounds() const override { return field_->bounds(); }
  std::size_t components() const override { return field_->components(); }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override { field_->spacing(x, found); }
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 protected:
  const VolumeField& field() const { return *field_; }
  double factor(std::size_t component) const { return factors_[component]; }
  void scale(const VolumeFieldValues& wanted) const;

 private:
  std::shared_ptr<const VolumeField> field_;
  std::vector<double> factors_;
};

}  // namespace sansmesh::inline v1
