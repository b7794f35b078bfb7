// One component, or the norm, of a vector volume.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Scalar field made from one of several components. Gradients follow from those of the components; where the vector
/// vanishes, its norm has no gradient and zero is returned.
class VolumeComponent : public VolumeField {
 public:
  /// `field` must outlive this object. `component` counts from 0; absent: the norm of the vector, or the only
  /// component. Throws ArgumentError for a component that does not exist.
  explicit VolumeComponent(const VolumeField& field, std::optional<std::size_t> component = std::nullopt);
  Box3 bounds() const override { return field_.bounds(); }
  std::size_t components() const override { return 1; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override { field_.spacing(x, found); }
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  const VolumeField& field_;
  std::optional<std::size_t> component_;
};

}  // namespace sansmesh::inline v1
