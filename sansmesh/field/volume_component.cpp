#include "sansmesh/field/volume_component.h"

#include <string>
#include <vector>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

VolumeComponent::VolumeComponent(const VolumeField& field, std::optional<std::size_t> component)
    : field_(field), component_(component) {
  const std::size_t count = field.components();
  if (component && *component >= count)
    throw ArgumentError("`component` must lie in 0.." + std::to_string(count - 1) + ", not " +
                        std::to_string(*component));
  if (count == 1) component_ = 0;
}

void VolumeComponent::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  const std::size_t count = field_.components();
  if (count == 1) return field_.evaluate(x, wanted);
  // The gradient of the norm also needs the vector.
  const bool want_values = !wanted.values.empty() || (!component_ && !wanted.gradients.empty());
  std::vector<double> values(want_values ? count * x.size() : 0);
  std::vector<Vec3> gradients(wanted.gradients.empty() ? 0 : count * x.size());
  field_.evaluate(x, {values, gradients, wanted.inside});
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (component_) {
      if (!wanted.values.empty()) wanted.values[i] = values[count * i + *component_];
      if (!wanted.gradients.empty()) wanted.gradients[i] = gradients[count * i + *component_];
      continue;
    }
    if (!want_values) continue;
    const double length = vector_length(std::span(values).subspan(count * i, count));
    if (!wanted.values.empty()) wanted.values[i] = length;
    if (wanted.gradients.empty()) continue;
    Vec3 g;
    if (length > 0)
      for (std::size_t k = 0; k < count; ++k) g += gradients[count * i + k] * (values[count * i + k] / length);
    wanted.gradients[i] = g;
  }
}

void VolumeComponent::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  // A field's ranges refer to its first component.
  if (component_ && *component_ == 0) return field_.ranges(boxes, found);
  VolumeField::ranges(boxes, found);
}

}  // namespace sansmesh::inline v1
