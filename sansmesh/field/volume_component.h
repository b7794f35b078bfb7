// One number of a quantity of several: a component, or how large a vector is.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/field/volume_field.h"

namespace sansmesh {

class VolumeComponent : public VolumeField {
 public:
  /// `component` below field->components(), or none: the Euclidean norm of all, whose gradient is zero where they are.
  VolumeComponent(std::shared_ptr<const VolumeField> field, std::optional<std::size_t> component);

  Box3 bounds() const override { return field_->bounds(); }
  std::size_t components() const override { return 1; }
  void evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const override;
  void spacing(std::span<const Vec3> x, std::span<double> found) const override { field_->spacing(x, found); }

 private:
  std::shared_ptr<const VolumeField> field_;
  std::optional<std::size_t> component_;
};

}  // namespace sansmesh
