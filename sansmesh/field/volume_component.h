// Numbers of a quantity of several components: one of them, or the length of the vector.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// A field of one component made of one of several. Its gradients follow from those of the components; where a vector
/// vanishes, its length has none and zero is the answer.
class VolumeComponent : public VolumeField {
 public:
  /// `field` must outlive it. `component` counts from 0; absent: the length of the vector, or, of a field of one
  /// component, that. Throws ArgumentError for a component that there is not.
  explicit VolumeComponent(const VolumeField& field, std::optional<std::size_t> component = std::nullopt);
  Box3 bounds() const override { return field_.bounds(); }
  std::size_t components() const override { return 1; }
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override { field_.spacing(x, found); }
  void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const override;

 private:
  const VolumeField& field_;
  std::optional<std::size_t> component_;
};

}  // namespace sansmesh::inline v1
