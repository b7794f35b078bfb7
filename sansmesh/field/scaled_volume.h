// A quantity in another unit: fields that were made of values of about 1 give them as the data have them.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// A field times a factor for each component. Powers of two leave every digit as it is.
class ScaledVolume : public VolumeField {
 public:
  /// `factors`: one a component, positive. Throws ArgumentError for another number of them.
  ScaledVolume(std::shared_ptr<const VolumeField> field, std::vector<double> factors);
  Box3 bounds() const override { return field_->bounds(); }
  std::size_t components() const override { return field_->components(); }
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override { field_->spacing(x, found); }
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  std::shared_ptr<const VolumeField> field_;
  std::vector<double> factors_;
};

}  // namespace sansmesh::inline v1
